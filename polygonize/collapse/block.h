// One cube of a mesh and the edges that are collapsed in it.
//   v0, v1  the ends of an edge, which become one vertex p, called v0 from then on
//   star    the triangles at v0 or v1; two of them vanish, the others become the fan of p
//   inside  a point in the block; a vertex is `free` when all triangles at it have all corners inside, and it is not kept
// Only edges between free vertices are collapsed, and only to points inside. So what a block changes lies inside, all of
// it, before and after; whatever could intersect it overlaps the block, and is loaded. That is why blocks need not know of
// each other, and why an intersection can be refused before it is made.
//
// Costs only grow when vertices merge, since quadrics add up. So a cost in the heap is a lower bound, and is computed anew
// only when it comes to the top.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "isowave/mesh.h"
#include "polygonize/collapse/lattice.h"
#include "polygonize/collapse/quadric.h"
#include "polygonize/stars.h"

namespace isowave::collapse {

using Index = std::uint32_t;
inline constexpr Index kNone = ~Index{0};

struct Limits {
    double cost = kInfinity;  // no collapse costs more
    std::int64_t collapses = std::numeric_limits<std::int64_t>::max();
    double longest2 = kInfinity;    // squared length of edges
    double deviation2 = kInfinity;  // mean square distance of a new vertex from the planes that it stands for

    static constexpr double kTurn = 75;      // degrees
    static constexpr double kNeedle = 0.05;  // height by longest side
};

// What a collapse would make of one triangle of the star: (p, b, c).
struct FanTriangle {
    Index id, b, c;
    Vec3 before, after;   // normals, as long as twice the area
    double longest2 = 0;  // squared longest side, after
    Facing facing = 0;    // after
};

struct Candidate {
    static constexpr int kLargest = 24;  // triangles; a vertex of more makes needles

    Index v0, v1;
    std::array<Index, 2> removed;   // triangles
    std::array<Index, 2> opposite;  // the vertices that face the edge
    std::array<FanTriangle, kLargest> fan;
    int size = 0;
    int ofFirst = 0;  // triangles of the fan that were v0's; those of v1 follow
    Vec3 normal;      // the sum of the star's, each as long as twice the triangle's area
    Vec3 at;          // p
    double cost = 0;
    double deviation2 = 0;  // of p from the planes of both ends, mean square

    FanTriangle* begin() { return fan.data(); }
    FanTriangle* end() { return fan.data() + size; }
};

// Each counts edges.
struct Counts {
    std::int64_t collapsed = 0, refusedTopology = 0, refusedShape = 0, refusedSheets = 0,
                 refusedDeviation = 0;
};

// For many blocks one after the other: load -> collapse -> store. Blocks may be loaded and stored at the same time: what
// one of them stores none of the others loads.
class Block {
  public:
    // begin .. end: the triangles that overlap the block. kept: by vertex, not 0 where it is not free; or empty. quadrics: by
    // vertex, about it; made, not read, when this is the `first` round. cell: side of the cubes in which other sheets are
    // looked for, world units.
    void load(const TriangleMesh& mesh, const std::vector<char>& kept, const std::vector<Quadric>& quadrics,
              bool first, const Index* begin, const Index* end, const Lattice& blocks, const Cell& block,
              double cell);

    // log: optional, gets the cost of each collapse.
    void collapse(const Limits& limits, std::vector<double>* log);

    // Only what is inside is written. A triangle that vanished is left as {0, 0, 0}.
    void store(TriangleMesh& mesh, std::vector<Quadric>& quadrics) const;

    const Counts& counts() const { return counts_; }

    // Triangles that have free corners only.
    std::int64_t freeTriangles() const;

  private:
    struct Star {
        Index first = 0, size = 0, room = 0;  // triangles: pool_[first .. first + size)
    };
    // An edge; its ends may have merged into others since.
    struct Entry {
        double cost;
        Index v0, v1, stamp;
        bool operator==(const Entry&) const = default;
    };
    struct Later {
        bool operator()(const Entry& a, const Entry& b) const {
            if (a.cost != b.cost) return a.cost > b.cost;
            return a.v0 != b.v0 ? a.v0 > b.v0 : a.v1 > b.v1;
        }
    };
    static constexpr Index kPlaced = 0x80000000;  // of a stamp: the cost is that of the point taken

    // -- load
    void number(const TriangleMesh& mesh, const Index* begin, const Index* end);
    Index localOf(const TriangleMesh& mesh, Index vertex);
    bool isInside(const Vec3& p) const { return blocks_->cellOf(p) == block_; }
    void gatherStars();
    void markFree(const std::vector<char>& kept);
    void makeQuadrics();

    Vec3 normalOf(const Triangle& t) const {
        return cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]);
    }
    void layCells(double side);
    double longest2Of(const Triangle& t) const;
    Box boxOf(const Triangle& t) const;
    void face(const Box& box, Facing facing);

    // -- the heap
    void fillHeap();
    void push(const Entry& entry);
    Quadric sumOf(Index v0, Index v1) const;

    // The least value of the sum of both quadrics: c - b' A^-1 b.
    double costOf(Index v0, Index v1) const;
    Index mergedInto(Index v);

    // True when the edge was collapsed.
    bool take(const Entry& top);

    // -- a candidate

    // The ends have just the two neighbours in common that face the edge, and are no tetrahedron's (the link condition of
    // Dey et al. 1999 for closed surfaces).
    bool gather(Candidate& c);
    FanTriangle turned(Index id, Index v) const;

    // The volume between star and fan is the sum of (a - x)'n / 6 over the star, n being the normal of a triangle, twice
    // its area long, and a one of its corners. So it is none on the plane g'x = d, g = sum n, d = sum a'n. There the least
    // value of Q is at x = A^-1 b + l A^-1 g, with l such that x lies on the plane (Lindstrom and Turk 1998 for memoryless
    // quadrics).
    bool place(Candidate& c);
    bool isShapely(Candidate& c) const;

    static bool turnsLittle(const Vec3& from, const Vec3& to);
    static bool isNeedle(const Vec3& normal, double longest2);
    // What direction a needle faces is noise: its star's normal says more.
    bool wasNeedle(const FanTriangle& t) const;
    // The least (height by longest side)^2 of the star's triangles.
    double thinnestOf(const Candidate& c) const;

    // -- other sheets
    bool isClear(Candidate& c);

    // If all triangles in a box, and those of the fan, face one direction, the surface in the box is a graph over a plane: of
    // two sheets one above the other in a closed surface, every other one faces away. The fan has the star's border and
    // covers, since none of its triangles is turned over, what the star has covered; nothing else lies there.
    bool facesOneWay(Candidate& c, const Cell& low, const Cell& high) const;
    bool meetsNothing(Candidate& c, const Cell& low, const Cell& high);

    // Two of the fan: they have p in common, and perhaps a side.
    bool areApart(const Candidate& c, const FanTriangle& t, const FanTriangle& u) const;
    bool areApart(const Candidate& c, const FanTriangle& t, const Triangle& u) const;

    // Lists of the triangles that overlap each cell, made when the first candidate needs them: thick solids have none.
    // Triangles that moved away since, or were collapsed, may stand in them.
    void list();
    void enter(Index id, const Box& box, const Box* before);

    template <class Each>
    void forListed(std::size_t cell, const Each& each) {
        for (Index* link = &heads_[cell]; *link != kNone;) {
            Node& node = nodes_[*link];
            if (isDegenerate(triangles_[node.triangle])) {
                *link = node.next;
                continue;
            }
            each(node.triangle);
            link = &node.next;
        }
    }

    // -- apply
    void apply(Candidate& c);
    void leave(Index v, Index triangle);
    void joinStars(const Candidate& c);

    struct Slot {
        Index vertex, local;
    };
    struct Node {
        Index triangle, next;
    };

    const Lattice* blocks_ = nullptr;
    Cell block_{};
    bool isFirst_ = false;
    Limits limits_;
    Counts counts_;
    Candidate candidate_;
    std::vector<Entry> heap_;
    // An edge comes to stand in the heap twice when two of a triangle merge. Equal costs come one after the other, so that
    // the second entry of one that was refused is known by this.
    Entry tried_{};
    // By vertex.
    std::vector<Vec3> points_;
    std::vector<Index> vertexOf_;  // of the mesh
    std::vector<char> inside_, free_;
    std::vector<Quadric> quadrics_;  // about the vertex
    std::vector<Star> stars_;
    std::vector<Index> versions_;  // grows with each merge, so that the sum of an edge's two does, too
    std::vector<Index> into_;
    std::vector<Index> marks_;
    Index mark_ = 0;
    // By triangle.
    std::vector<Triangle> triangles_;
    std::vector<Index> triangleOf_;  // of the mesh
    std::vector<Index> pool_;
    // By cell.
    Lattice cells_;
    std::vector<Facing> facing_;  // what all triangles that ever overlapped the cell have in common
    bool listed_ = false;
    std::vector<Index> heads_, seen_;
    std::vector<Node> nodes_;
    Index query_ = 0;
    std::vector<Slot> table_;
};

}  // namespace isowave::collapse
