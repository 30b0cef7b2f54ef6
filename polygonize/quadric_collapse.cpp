// collapse = pilot -> rounds. In a round space is cut into cubes, the blocks, half a block off those of the round before.
// Blocks are worked on in parallel, each with a heap of its own: load -> collapse -> store.
//   v0, v1  the ends of an edge, which become one vertex p, called v0 from then on
//   star    the triangles at v0 or v1; two of them vanish, the others become the fan of p
//   inside  a point in the block; a vertex is `free` when all triangles at it have all corners inside
// Only edges between free vertices are collapsed, and only to points inside. So what a block changes lies inside, all of
// it, before and after; whatever could intersect it overlaps the block, and is loaded. That is why blocks need not know of
// each other, and why an intersection can be refused before it is made.
//
// Costs only grow when vertices merge, since quadrics add up. So a cost in the heap is a lower bound, and is computed anew
// only when it comes to the top.
#include "polygonize/quadric_collapse.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/triangle.h"
#include "polygonize/apart.h"
#include "polygonize/quadric.h"
#include "polygonize/stars.h"

namespace isowave {
namespace {

using Index = std::uint32_t;
constexpr Index kNone = ~Index{0};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---- directions

// Bit i of a triangle's or a cell's facing: its normals are within a right angle of direction i, to a margin beyond rounding.
using Facing = std::uint32_t;

// Of each pair of opposite ones among the 26 neighbours of a cell of a lattice one.
constexpr std::array<Vec3, 13> kDirections{{{1, 0, 0},
                                            {0, 1, 0},
                                            {0, 0, 1},
                                            {0.7, 0.7, 0},
                                            {0.7, -0.7, 0},
                                            {0.7, 0, 0.7},
                                            {0.7, 0, -0.7},
                                            {0, 0.7, 0.7},
                                            {0, 0.7, -0.7},
                                            {0.58, 0.58, 0.58},
                                            {0.58, 0.58, -0.58},
                                            {0.58, -0.58, 0.58},
                                            {0.58, -0.58, -0.58}}};

// longest: of the triangle's sides; its normal is wrong by 1e-15 of the square at most.
Facing facingOf(const Vec3& normal, double longest2) {
    const double margin = 0.02 * length(normal) + 1e-14 * longest2;
    Facing facing = 0;
    for (std::size_t i = 0; i < kDirections.size(); ++i) {
        const double along = dot(kDirections[i], normal);
        facing |= static_cast<Facing>(along > margin) << (2 * i);
        facing |= static_cast<Facing>(along < -margin) << (2 * i + 1);
    }
    return facing;
}

// ---- lattices

struct Box {
    Vec3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};

    void add(const Vec3& p) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    bool meets(const Box& o) const {
        return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
               low.z <= o.high.z && o.low.z <= high.z;
    }
};

using Cell = std::array<int, 3>;

// Cubes of a size, numbered from 0 on each axis. Points beyond belong to the nearest cube. A cube's number grows with the
// coordinate, whatever rounding does; so a box overlaps just the cubes from that of its low corner to that of its high one.
struct Lattice {
    Vec3 origin;
    double side = 1, perSide = 1;  // 1 / side
    Cell count{1, 1, 1};

    Cell cellOf(const Vec3& p) const {
        Cell cell;
        for (int a = 0; a < 3; ++a)
            cell[a] = static_cast<int>(
                std::clamp((p[a] - origin[a]) * perSide, 0.0, static_cast<double>(count[a] - 1)));
        return cell;
    }
    std::size_t size() const {
        return static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
               static_cast<std::size_t>(count[2]);
    }
    std::size_t indexOf(int x, int y, int z) const {
        return (static_cast<std::size_t>(x) * static_cast<std::size_t>(count[1]) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(count[2]) +
               static_cast<std::size_t>(z);
    }
    // each(index) for all cells between two corners; stops when it says false.
    template <class Each>
    void forCells(const Cell& low, const Cell& high, const Each& each) const {
        for (int x = low[0]; x <= high[0]; ++x)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int z = low[2]; z <= high[2]; ++z)
                    if (!each(indexOf(x, y, z))) return;
    }
};

// ---- one block

struct Limits {
    double cost = kInfinity;  // no collapse costs more
    std::int64_t collapses = std::numeric_limits<std::int64_t>::max();
    double longest2 = kInfinity;  // squared length of edges
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
    Vec3 at;          // p
    double cost = 0;

    FanTriangle* begin() { return fan.data(); }
    FanTriangle* end() { return fan.data() + size; }
};

class Block {
  public:
    // triangles: all that overlap the block. `first`: the quadrics are made, not read.
    void load(const TriangleMesh& mesh, const std::vector<Quadric>& quadrics, bool first, const Index* begin,
              const Index* end, const Lattice& blocks, const Cell& block, double cell) {
        blocks_ = &blocks;
        block_ = block;
        number(mesh, begin, end);
        gatherStars();
        markFree();
        if (first)
            makeQuadrics();
        else
            for (std::size_t v = 0; v < points_.size(); ++v) quadrics_[v] = quadrics[vertexOf_[v]];
        layCells(cell);
        report_ = {};
    }

    // log: optional, gets the cost of each collapse.
    void collapse(const Limits& limits, std::vector<double>* log) {
        limits_ = limits;
        fillHeap();
        while (!heap_.empty() && report_.collapsed < limits.collapses) {
            const Entry top = heap_.front();
            if (!(top.cost <= limits.cost)) break;
            std::pop_heap(heap_.begin(), heap_.end(), Later{});
            heap_.pop_back();
            if (take(top) && log) log->push_back(top.cost);
        }
    }

    // Only what is inside is written. A triangle that vanished is left degenerate.
    void store(TriangleMesh& mesh, std::vector<Quadric>& quadrics) const {
        for (std::size_t v = 0; v < points_.size(); ++v) {
            if (!inside_[v]) continue;
            quadrics[vertexOf_[v]] = quadrics_[v];
            if (free_[v]) mesh.points[vertexOf_[v]] = {points_[v].x, points_[v].y, points_[v].z};
        }
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            const Triangle& corners = triangles_[t];
            if (isDegenerate(corners))
                mesh.triangles[triangleOf_[t]] = {0, 0, 0};
            else if (inside_[corners[0]] && inside_[corners[1]] && inside_[corners[2]])
                mesh.triangles[triangleOf_[t]] = {vertexOf_[corners[0]], vertexOf_[corners[1]],
                                                  vertexOf_[corners[2]]};
        }
    }

    const CollapseReport& report() const { return report_; }

    // Triangles that have free corners only.
    std::int64_t freeTriangles() const {
        return std::count_if(triangles_.begin(), triangles_.end(),
                             [&](const Triangle& t) { return free_[t[0]] && free_[t[1]] && free_[t[2]]; });
    }

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
    static constexpr Index kPlaced = Index{1}
                                     << 31;  // of a stamp: the cost is that of the point that is taken

    // -- load

    void number(const TriangleMesh& mesh, const Index* begin, const Index* end) {
        const std::size_t count = static_cast<std::size_t>(end - begin);
        std::size_t slots = 64;
        while (slots < 4 * count) slots *= 2;
        table_.assign(slots, {kNone, 0});
        points_.clear(), vertexOf_.clear(), inside_.clear(), triangles_.clear();
        triangleOf_.assign(begin, end);
        triangles_.reserve(count);
        for (const Index id : triangleOf_) {
            Triangle t = mesh.triangles[id];
            for (Index& v : t) v = localOf(mesh, v);
            triangles_.push_back(t);
        }
    }

    Index localOf(const TriangleMesh& mesh, Index vertex) {
        const std::size_t mask = table_.size() - 1;
        std::size_t slot = (vertex * std::size_t{0x9e3779b97f4a7c15}) >> 40 & mask;
        while (table_[slot].vertex != vertex) {
            if (table_[slot].vertex != kNone) {
                slot = (slot + 1) & mask;
                continue;
            }
            table_[slot] = {vertex, static_cast<Index>(points_.size())};
            vertexOf_.push_back(vertex);
            points_.push_back(toVec3(mesh.points[vertex]));
            inside_.push_back(isInside(points_.back()));
        }
        return table_[slot].local;
    }

    bool isInside(const Vec3& p) const { return blocks_->cellOf(p) == block_; }

    void gatherStars() {
        const std::size_t count = points_.size();
        stars_.assign(count, {});
        for (const Triangle& t : triangles_)
            for (const Index v : t) ++stars_[v].room;
        Index first = 0;
        for (Star& star : stars_) {
            star.first = first;
            first += star.room;
        }
        pool_.resize(first);
        for (Index t = 0; t < triangles_.size(); ++t)
            for (const Index v : triangles_[t]) pool_[stars_[v].first + stars_[v].size++] = t;
        versions_.assign(count, 0);
        into_.resize(count);
        std::iota(into_.begin(), into_.end(), Index{0});
        marks_.assign(count, 0);
        mark_ = 0;
    }

    void markFree() {
        free_ = inside_;
        for (const Triangle& t : triangles_)
            if (!(inside_[t[0]] && inside_[t[1]] && inside_[t[2]]))
                free_[t[0]] = free_[t[1]] = free_[t[2]] = 0;
    }

    void makeQuadrics() {
        quadrics_.assign(points_.size(), {});
        for (const Triangle& t : triangles_) {
            const Quadric q = Quadric::ofCorner(normalOf(t));
            for (const Index v : t) quadrics_[v] += q;
        }
    }

    Vec3 normalOf(const Triangle& t) const {
        return cross(points_[t[1]] - points_[t[0]], points_[t[2]] - points_[t[0]]);
    }

    void layCells(double side) {
        cells_.side = side, cells_.perSide = 1 / side;
        for (int a = 0; a < 3; ++a) {
            cells_.origin[a] = blocks_->origin[a] + blocks_->side * block_[a];
            cells_.count[a] = static_cast<int>(std::ceil(blocks_->side / side));
        }
        facing_.assign(cells_.size(), ~Facing{0});
        listed_ = false;
        for (const Triangle& t : triangles_) face(boxOf(t), facingOf(normalOf(t), longest2Of(t)));
    }

    double longest2Of(const Triangle& t) const {
        const Vec3 a = points_[t[1]] - points_[t[0]], b = points_[t[2]] - points_[t[1]],
                   c = points_[t[0]] - points_[t[2]];
        return std::max({dot(a, a), dot(b, b), dot(c, c)});
    }

    Box boxOf(const Triangle& t) const {
        Box box;
        for (const Index v : t) box.add(points_[v]);
        return box;
    }

    void face(const Box& box, Facing facing) {
        cells_.forCells(cells_.cellOf(box.low), cells_.cellOf(box.high), [&](std::size_t cell) {
            facing_[cell] &= facing;
            return true;
        });
    }

    // -- the heap

    void fillHeap() {
        heap_.clear();
        tried_ = {0, kNone, kNone, 0};
        for (const Triangle& t : triangles_)
            for (int k = 0; k < 3; ++k) {
                const Index v0 = t[k], v1 = t[(k + 1) % 3];
                if (v0 > v1 || !free_[v0] || !free_[v1]) continue;
                const double cost = costOf(v0, v1);
                if (cost <= limits_.cost) heap_.push_back({cost, v0, v1, 0});
            }
        std::make_heap(heap_.begin(), heap_.end(), Later{});
    }

    void push(const Entry& entry) {
        if (!(entry.cost <= limits_.cost)) return;
        heap_.push_back(entry);
        std::push_heap(heap_.begin(), heap_.end(), Later{});
    }

    Quadric sumOf(Index v0, Index v1) const {
        Quadric q = quadrics_[v1].about(points_[v0] - points_[v1]);
        q += quadrics_[v0];
        return q;
    }

    // The least value of the sum of both quadrics: c - b' A^-1 b.
    double costOf(Index v0, Index v1) const {
        const Quadric q = sumOf(v0, v1);
        const QuadricSolver solver(q);
        return solver.solvable() ? std::max(0.0, q.c - dot(q.b, solver.solve(q.b))) : 0;
    }

    Index mergedInto(Index v) {
        while (into_[v] != v) v = into_[v] = into_[into_[v]];
        return v;
    }

    // True when the edge was collapsed.
    bool take(const Entry& top) {
        const Index v0 = mergedInto(top.v0), v1 = mergedInto(top.v1);
        if (v0 == v1) return false;
        const Index stamp = versions_[v0] + versions_[v1];
        if ((top.stamp & ~kPlaced) != stamp) {
            push({std::max(top.cost, costOf(v0, v1)), v0, v1, stamp});
            return false;
        }
        const Entry trial{0, std::min(v0, v1), std::max(v0, v1), top.stamp};
        if (tried_ == trial) return false;
        tried_ = trial;
        Candidate& c = candidate_;
        c.v0 = v0, c.v1 = v1;
        if (!gather(c)) return ++report_.refusedTopology, false;
        if (!place(c)) return ++report_.refusedShape, false;
        constexpr double kMuch = 1.1;  // a cost that grew by less keeps its turn
        if (!(top.stamp & kPlaced) && c.cost > kMuch * top.cost && c.cost > 0) {
            push({c.cost, v0, v1, stamp | kPlaced});
            return false;
        }
        if (!isShapely(c)) return ++report_.refusedShape, false;
        if (!isClear(c)) return ++report_.refusedSheets, false;
        apply(c);
        ++report_.collapsed;
        return true;
    }

    // -- a candidate

    // The ends have just the two neighbours in common that face the edge, and are no tetrahedron's (the link condition of
    // Dey et al. 1999 for closed surfaces).
    bool gather(Candidate& c) {
        c.size = 0;
        ++mark_;
        int removed = 0, common = 0;
        const Star &s0 = stars_[c.v0], &s1 = stars_[c.v1];
        if (s0.size + s1.size - 4 > Candidate::kLargest || s0.size + s1.size < 7) return false;
        for (Index i = 0; i < s0.size; ++i) {
            const FanTriangle t = turned(pool_[s0.first + i], c.v0);
            marks_[t.b] = mark_;
            if (t.b != c.v1 && t.c != c.v1) {
                c.fan[c.size++] = t;
                continue;
            }
            if (removed == 2) return false;
            c.removed[removed] = t.id;
            c.opposite[removed++] = t.b == c.v1 ? t.c : t.b;
        }
        c.ofFirst = c.size;
        for (Index i = 0; i < s1.size; ++i) {
            const FanTriangle t = turned(pool_[s1.first + i], c.v1);
            common += marks_[t.b] == mark_ ? 1 : 0;
            if (t.b != c.v0 && t.c != c.v0) c.fan[c.size++] = t;
        }
        return removed == 2 && common == 2;
    }

    FanTriangle turned(Index id, Index v) const {
        const Triangle& t = triangles_[id];
        const int k = t[0] == v ? 0 : t[1] == v ? 1 : 2;
        return {id, t[(k + 1) % 3], t[(k + 2) % 3], {}, {}};
    }

    // The volume between star and fan is the sum of (a - x)'n / 6 over the star, n being the normal of a triangle, twice
    // its area long, and a one of its corners. So it is none on the plane g'x = d, g = sum n, d = sum a'n. There the least
    // value of Q is at x = A^-1 b + l A^-1 g, with l such that x lies on the plane (Lindstrom and Turk 1998 for memoryless
    // quadrics).
    bool place(Candidate& c) {
        const Vec3 origin = points_[c.v0], edge = points_[c.v1] - origin;
        Vec3 ofFirst, ofSecond;  // sums of normals
        double area = 0, reach2 = 0;
        for (int i = 0; i < c.size; ++i) {
            FanTriangle& t = c.fan[i];
            const Vec3& corner = points_[i < c.ofFirst ? c.v0 : c.v1];
            const Vec3 side = points_[t.b] - corner;
            t.before = cross(side, points_[t.c] - corner);
            (i < c.ofFirst ? ofFirst : ofSecond) += t.before;
            area += length(t.before);
            reach2 = std::max(reach2, dot(side, side));
        }
        for (const Index id : c.removed) ofFirst += normalOf(triangles_[id]);
        const Vec3 g = ofFirst + ofSecond;
        const double d = dot(ofSecond, edge);
        const Quadric q = sumOf(c.v0, c.v1);
        const QuadricSolver solver(q);
        const Vec3 middle = 0.5 * edge;
        constexpr double kFlat = 1e-3;  // of the area: below it g is the difference of what cancels
        const bool keepsVolume = length(g) > kFlat * area;
        Vec3 x = middle;
        if (solver.solvable()) {
            x = solver.solve(q.b);
            const Vec3 towards = solver.solve(g);
            if (keepsVolume) x += ((d - dot(g, x)) / dot(g, towards)) * towards;
        }
        const auto isNear = [&](const Vec3& y) {
            return dot(y - middle, y - middle) <= std::max(dot(edge, edge), reach2 / 4);
        };
        if (!isNear(x)) x = keepsVolume ? middle + ((d - dot(g, middle)) / dot(g, g)) * g : middle;
        if (!isNear(x)) x = middle;
        c.at = origin + x;
        c.cost = std::max(0.0, q.at(x));
        return isInside(c.at);
    }

    bool isShapely(Candidate& c) const {
        static const double kLeast2 = std::pow(std::cos(CollapseOptions::kTurn * std::numbers::pi / 180), 2);
        constexpr double kNeedle2 = CollapseOptions::kNeedle * CollapseOptions::kNeedle;
        for (FanTriangle& t : c) {
            const Vec3 b = points_[t.b] - c.at, e = points_[t.c] - c.at, opposite = e - b;
            t.after = cross(b, e);
            t.longest2 = std::max({dot(b, b), dot(e, e), dot(opposite, opposite)});
            const double cosine = dot(t.after, t.before), after2 = dot(t.after, t.after);
            if (!(cosine > 0) || !(cosine * cosine > kLeast2 * after2 * dot(t.before, t.before)))
                return false;
            if (std::max(dot(b, b), dot(e, e)) > limits_.longest2) return false;
            if (after2 < kNeedle2 * t.longest2 * t.longest2 && isThinner(t)) return false;
        }
        return true;
    }

    // Than it was.
    bool isThinner(const FanTriangle& t) const {
        const double longest2 = longest2Of(triangles_[t.id]);
        return dot(t.after, t.after) * longest2 * longest2 <
               dot(t.before, t.before) * t.longest2 * t.longest2;
    }

    // -- other sheets

    bool isClear(Candidate& c) {
        Box box;
        box.add(c.at), box.add(points_[c.v0]), box.add(points_[c.v1]);
        for (const FanTriangle& t : c) box.add(points_[t.b]);
        const Cell low = cells_.cellOf(box.low), high = cells_.cellOf(box.high);
        return facesOneWay(c, low, high) || meetsNothing(c, low, high);
    }

    // If all triangles in a box, and those of the fan, face one direction, the surface in the box is a graph over a plane: of
    // two sheets one above the other in a closed surface, every other one faces away. The fan has the star's border and
    // covers, since none of its triangles is turned over, what the star has covered; nothing else lies there.
    bool facesOneWay(Candidate& c, const Cell& low, const Cell& high) const {
        Facing facing = ~Facing{0};
        for (FanTriangle& t : c) facing &= t.facing = facingOf(t.after, t.longest2);
        cells_.forCells(low, high, [&](std::size_t cell) { return (facing &= facing_[cell]) != 0; });
        return facing != 0;
    }

    bool meetsNothing(Candidate& c, const Cell& low, const Cell& high) {
        for (int i = 0; i < c.size; ++i)
            for (int j = i + 1; j < c.size; ++j)
                if (!areApart(c, c.fan[i], c.fan[j])) return false;
        if (!listed_) list();
        Box whole;
        std::array<Box, Candidate::kLargest> boxes;
        for (int i = 0; i < c.size; ++i) {
            boxes[i].add(c.at), boxes[i].add(points_[c.fan[i].b]), boxes[i].add(points_[c.fan[i].c]);
            whole.add(boxes[i].low), whole.add(boxes[i].high);
        }
        ++query_;
        for (const FanTriangle& t : c) seen_[t.id] = query_;
        for (const Index id : c.removed) seen_[id] = query_;
        bool apart = true;
        cells_.forCells(low, high, [&](std::size_t cell) {
            forListed(cell, [&](Index id) {
                if (!apart || seen_[id] == query_) return;
                seen_[id] = query_;
                const Box box = boxOf(triangles_[id]);
                if (!box.meets(whole)) return;
                for (int i = 0; i < c.size && apart; ++i)
                    apart = !boxes[i].meets(box) || areApart(c, c.fan[i], triangles_[id]);
            });
            return apart;
        });
        return apart;
    }

    // Two of the fan: they have p in common, and perhaps a side.
    bool areApart(const Candidate& c, const FanTriangle& t, const FanTriangle& u) const {
        if (t.b == u.c || t.c == u.b) return triangleIsUnfolded(t.after, u.after);
        return triangleIsApartAtCorner(points_[t.b] - c.at, points_[t.c] - c.at, points_[u.b] - c.at,
                                       points_[u.c] - c.at);
    }

    bool areApart(const Candidate& c, const FanTriangle& t, const Triangle& u) const {
        int corner = -1, shared = 0, ofFan = 0;
        for (int k = 0; k < 3; ++k)
            if (u[k] == t.b || u[k] == t.c) {
                ++shared;
                corner = k;
                ofFan = u[k] == t.b ? 0 : 1;
            }
        if (shared == 2) return triangleIsUnfolded(t.after, normalOf(u));
        const Vec3 &b = points_[t.b], &e = points_[t.c];
        if (shared == 0) return triangleIsApart({c.at, b, e}, {points_[u[0]], points_[u[1]], points_[u[2]]});
        const Vec3& o = ofFan == 0 ? b : e;
        return triangleIsApartAtCorner((ofFan == 0 ? e : b) - o, c.at - o, points_[u[(corner + 1) % 3]] - o,
                                       points_[u[(corner + 2) % 3]] - o);
    }

    // Lists of the triangles that overlap each cell, made when the first block's wall is thin enough to need them. Triangles
    // that moved away since, or were collapsed, may stand in them.
    void list() {
        listed_ = true;
        heads_.assign(cells_.size(), kNone);
        nodes_.clear();
        seen_.assign(triangles_.size(), 0);
        query_ = 0;
        for (Index t = 0; t < triangles_.size(); ++t)
            if (!isDegenerate(triangles_[t])) enter(t, boxOf(triangles_[t]), nullptr);
    }

    void enter(Index id, const Box& box, const Box* before) {
        const Cell low = cells_.cellOf(box.low), high = cells_.cellOf(box.high);
        Cell oldLow{1, 1, 1}, oldHigh{0, 0, 0};
        if (before) oldLow = cells_.cellOf(before->low), oldHigh = cells_.cellOf(before->high);
        for (int x = low[0]; x <= high[0]; ++x)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int z = low[2]; z <= high[2]; ++z) {
                    if (x >= oldLow[0] && x <= oldHigh[0] && y >= oldLow[1] && y <= oldHigh[1] &&
                        z >= oldLow[2] && z <= oldHigh[2])
                        continue;
                    Index& head = heads_[cells_.indexOf(x, y, z)];
                    nodes_.push_back({id, head});
                    head = static_cast<Index>(nodes_.size() - 1);
                }
    }

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

    void apply(Candidate& c) {
        quadrics_[c.v0] = sumOf(c.v0, c.v1).about(c.at - points_[c.v0]);
        std::array<Box, Candidate::kLargest> before;
        if (listed_)
            for (int i = 0; i < c.size; ++i) before[i] = boxOf(triangles_[c.fan[i].id]);
        points_[c.v0] = c.at;
        for (int i = 0; i < 2; ++i) {
            leave(c.opposite[i], c.removed[i]);
            triangles_[c.removed[i]] = {0, 0, 0};
        }
        joinStars(c);
        for (int i = 0; i < c.size; ++i) {
            const FanTriangle& t = c.fan[i];
            triangles_[t.id] = {c.v0, t.b, t.c};
            const Box box = boxOf(triangles_[t.id]);
            face(box, t.facing);
            if (listed_) enter(t.id, box, &before[i]);
        }
        versions_[c.v0] += versions_[c.v1] + 1;
        into_[c.v1] = c.v0;
    }

    void leave(Index v, Index triangle) {
        Star& star = stars_[v];
        Index* const first = &pool_[star.first];
        *std::find(first, first + star.size, triangle) = first[star.size - 1];
        --star.size;
    }

    void joinStars(const Candidate& c) {
        Star &s0 = stars_[c.v0], &s1 = stars_[c.v1];
        const Index size = static_cast<Index>(c.size);
        if (s1.room > s0.room) s0 = s1;
        if (s0.room < size) {
            s0 = {static_cast<Index>(pool_.size()), 0, size};
            pool_.resize(pool_.size() + size);
        }
        s0.size = size;
        s1 = {};
        for (int i = 0; i < c.size; ++i) pool_[s0.first + static_cast<Index>(i)] = c.fan[i].id;
    }

    struct Slot {
        Index vertex, local;
    };
    struct Node {
        Index triangle, next;
    };

    const Lattice* blocks_ = nullptr;
    Cell block_{};
    Limits limits_;
    CollapseReport report_;
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

// ---- all blocks

constexpr double kBlockSide = 48, kCellSide = 2;  // mean edges

// Of a sample of triangles: every k-th.
double meanEdge(const TriangleMesh& mesh) {
    constexpr std::size_t kSample = 1 << 16;
    const std::size_t stride = mesh.triangles.size() / kSample + 1;
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += stride, ++count) {
        const Triangle& t = mesh.triangles[i];
        for (int k = 0; k < 3; ++k)
            sum += length(toVec3(mesh.points[t[(k + 1) % 3]]) - toVec3(mesh.points[t[k]]));
    }
    return count == 0 ? 0 : sum / (3 * static_cast<double>(count));
}

class Collapsing {
  public:
    Collapsing(TriangleMesh& mesh, const CollapseOptions& options, const Progress& progress)
        : mesh_(mesh), progress_(progress), wanted_(static_cast<std::int64_t>(mesh.triangles.size())) {
        wanted_ = std::max<std::int64_t>(0, (wanted_ - options.triangles + 1) / 2);
        if (options.longest > 0) limits_.longest2 = options.longest * options.longest;
        for (const Point& p : mesh.points) bounds_.add(toVec3(p));
        quadrics_.resize(mesh.points.size());
    }

    // The first two rounds take all that the pilot found to be cheap enough, the second one at the borders of the first
    // one's blocks. Later ones share out what is left to do.
    CollapseReport run() {
        if (wanted_ == 0) return report_;
        cut(0);
        double cost = isSmall() ? kInfinity : pilot();
        for (int round = 0, idle = 0; left() > 0 && idle < kPatience; ++round) {
            progress_("collapsing", static_cast<double>(report_.collapsed) / static_cast<double>(wanted_));
            if (round > 0) cut(round);
            if (round > 1) cost = idle > 0 ? kInfinity : kRaise * cost;
            const std::int64_t before = report_.collapsed, toDo = left();
            work(round, cost);
            idle = report_.collapsed - before < toDo / kIdle + 1 ? idle + 1 : 0;
            ++report_.rounds;
        }
        return report_;
    }

  private:
    static constexpr std::size_t kSmall = 20'000;  // triangles
    static constexpr int kPatience = 4;            // idle rounds: every shift was tried
    static constexpr std::int64_t kIdle =
        100;                                // a round is idle that does less than this part of what is left
    static constexpr double kRaise = 2;     // of the cost allowed, from round to round
    static constexpr double kShort = 0.97;  // of the collapses wanted are left to the pilot's cost

    std::int64_t left() const { return wanted_ - report_.collapsed; }

    // The blocks of a round, and the triangles that overlap each.
    void cut(int round) {
        constexpr std::array<double, 4> kShift{0, 0.5, 0.25, 0.75};  // of a block
        const double edge = meanEdge(mesh_);
        cell_ = kCellSide * edge;
        layBlocks(kBlockSide * edge, kShift[static_cast<std::size_t>(round) % kShift.size()]);
        first_.assign(blocks_.size() + 1, 0);
        std::vector<Cell> cells(mesh_.points.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 4096), [&](const auto& range) {
            for (std::size_t v = range.begin(); v != range.end(); ++v)
                cells[v] = blocks_.cellOf(toVec3(mesh_.points[v]));
        });
        const auto forBlocks = [&](const Triangle& t, const auto& each) {
            Cell low = cells[t[0]], high = low;
            for (int k = 1; k < 3; ++k)
                for (int a = 0; a < 3; ++a) {
                    low[a] = std::min(low[a], cells[t[k]][a]);
                    high[a] = std::max(high[a], cells[t[k]][a]);
                }
            blocks_.forCells(low, high, [&](std::size_t block) { return each(block), true; });
        };
        for (const Triangle& t : mesh_.triangles)
            forBlocks(t, [&](std::size_t block) { ++first_[block + 1]; });
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        listed_.resize(first_.back());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (Index t = 0; t < mesh_.triangles.size(); ++t)
            forBlocks(mesh_.triangles[t], [&](std::size_t block) { listed_[next[block]++] = t; });
        used_.clear();
        for (std::size_t block = 0; block < blocks_.size(); ++block)
            if (first_[block] != first_[block + 1]) used_.push_back(block);
    }

    // One block for all: it is done before a pilot would be.
    bool isSmall() const { return mesh_.triangles.size() <= kSmall; }

    // Larger ones where they would be more than the triangles.
    void layBlocks(double side, double shift) {
        const double most = isSmall() ? 1 : 1000 + static_cast<double>(mesh_.triangles.size());
        if (isSmall()) shift = 0;
        for (side = side > 0 ? side : 1;; side *= 2) {
            blocks_.side = side, blocks_.perSide = 1 / side;
            double count = 1;
            for (int a = 0; a < 3; ++a) {
                blocks_.origin[a] = bounds_.low[a] - shift * side;
                count *= std::floor((bounds_.high[a] - blocks_.origin[a]) / side) + 1;
            }
            if (!(count > most)) break;
        }
        for (int a = 0; a < 3; ++a)
            blocks_.count[a] =
                static_cast<int>(std::floor((bounds_.high[a] - blocks_.origin[a]) / blocks_.side)) + 1;
    }

    void load(Block& block, std::size_t used, bool first) const {
        const std::size_t index = used_[used], y = static_cast<std::size_t>(blocks_.count[1]),
                          z = static_cast<std::size_t>(blocks_.count[2]);
        const Cell cell{static_cast<int>(index / (y * z)), static_cast<int>(index / z % y),
                        static_cast<int>(index % z)};
        block.load(mesh_, quadrics_, first, &listed_[0] + first_[index], &listed_[0] + first_[index + 1],
                   blocks_, cell, cell_);
    }

    // Collapses some of the blocks, in copies, farther than all are to be. Returns the cost up to which about
    // the number of collapses wanted is done.
    double pilot() {
        const std::size_t count = std::min(used_.size(), std::clamp<std::size_t>(used_.size() / 8, 4, 24));
        std::vector<std::vector<double>> costs(count);
        std::vector<std::int64_t> triangles(count);
        forEach(count, [&](Block& block, std::size_t i) {
            load(block, i * used_.size() / count, true);
            triangles[i] = block.freeTriangles();
            block.collapse(limits_, &costs[i]);
        });
        std::vector<double> all;
        for (const auto& some : costs) all.insert(all.end(), some.begin(), some.end());
        std::sort(all.begin(), all.end());
        const double sampled =
            static_cast<double>(std::accumulate(triangles.begin(), triangles.end(), std::int64_t{0})) /
            static_cast<double>(mesh_.triangles.size());
        const auto rank = static_cast<std::size_t>(kShort * sampled * static_cast<double>(wanted_));
        if (all.empty()) return 0;
        return all[std::min(rank, all.size() - 1)];
    }

    void work(int round, double cost) {
        std::vector<CollapseReport> reports(used_.size());
        const std::int64_t toDo = left();
        forEach(used_.size(), [&](Block& block, std::size_t i) {
            Limits limits = limits_;
            limits.cost = cost;
            limits.collapses = round < 2 ? toDo : shareOf(i, toDo);
            load(block, i, round == 0);
            block.collapse(limits, nullptr);
            block.store(mesh_, quadrics_);
            reports[i] = block.report();
        });
        for (const CollapseReport& r : reports) {
            report_.collapsed += r.collapsed;
            report_.refusedTopology += r.refusedTopology;
            report_.refusedShape += r.refusedShape;
            report_.refusedSheets += r.refusedSheets;
        }
        std::erase_if(mesh_.triangles, isDegenerate);
    }

    // Of the collapses that are left, by its triangles, rounded upwards.
    std::int64_t shareOf(std::size_t used, std::int64_t toDo) const {
        const auto has = static_cast<double>(first_[used_[used] + 1] - first_[used_[used]]);
        return static_cast<std::int64_t>(
            std::ceil(static_cast<double>(toDo) * has / static_cast<double>(listed_.size())));
    }

    template <class Each>
    void forEach(std::size_t count, const Each& each) {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&](const auto& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) {
                    progress_.check();
                    each(workspaces_.local(), i);
                }
            },
            tbb::simple_partitioner());
    }

    TriangleMesh& mesh_;
    const Progress& progress_;
    std::int64_t wanted_;  // collapses
    Limits limits_;
    Box bounds_;
    CollapseReport report_;
    std::vector<Quadric> quadrics_;  // by vertex, about it
    Lattice blocks_;
    double cell_ = 0;
    std::vector<std::size_t> first_, used_;  // by block; the blocks that are not empty
    std::vector<Index> listed_;
    tbb::enumerable_thread_specific<Block> workspaces_;
};

void dropUnusedPoints(TriangleMesh& mesh) {
    std::vector<Index> number(mesh.points.size(), kNone);
    for (const Triangle& t : mesh.triangles)
        for (const Index v : t) number[v] = 0;
    Index next = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kNone) continue;
        mesh.points[next] = mesh.points[v];
        number[v] = next++;
    }
    mesh.points.resize(next);
    for (Triangle& t : mesh.triangles)
        for (Index& v : t) v = number[v];
}

}  // namespace

void collapseByQuadrics(TriangleMesh& mesh, const CollapseOptions& options, CollapseReport* report,
                        const Progress& progress) {
    mesh.normals.clear();
    const CollapseReport done = Collapsing(mesh, options, progress).run();
    dropUnusedPoints(mesh);
    progress("collapsing", 1.0);
    if (report) *report = done;
}

}  // namespace isowave
