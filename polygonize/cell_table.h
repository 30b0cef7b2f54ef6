// Marching cubes' cases, generated from rules instead of typed in: for every pattern of signs, every decision
// about its ambiguous faces and either sign of the cell's middle.
//
// A cell is the cube between 8 lattice points. Corner c = x + 2y + 4z with x, y, z in {0, 1}; bit c of a
// pattern says that corner c is inside. Edge e = 4a + k runs along axis a (0 x, 1 y, 2 z) from the corner
// whose coordinates on the axes a+1, a+2 (cyclic) are k & 1, k >> 1. An edge whose ends differ carries one
// vertex. Face 2a is the cell's low face on axis a, 2a + 1 the high one.
//
//   faces    On every face the inside corners fall into runs (going round the face), and each run is cut off
//            by one segment. A face with two opposite inside corners is ambiguous: they are two runs, or joined
//            across the face's middle. The caller decides, by the field's sign there; the two cells that
//            share the face ask for the sign at the same place, so they agree.
//   loops    A vertex lies on two faces of the cell, entered on one and left on the other: segments close up
//            into loops, directed so that they run counter-clockwise seen from outside the solid. Loops cut the
//            cell's surface into regions, inside and outside in turn.
//   middle   The regions of the sign that the cell's middle has are connected through it; every other region
//            is cut off from it by one surface, whose border is the region's loops. So two loops are joined by
//            a tunnel where the field says so, as faces are.
//   filling  A region with one loop: the loop is triangulated without any diagonal that has both ends on one
//            face, the shortest diagonals first. Where there is none whose triangles keep clear of each other, and
//            for a region with several loops, the surface is drawn radially over the region: one vertex on the ray from the
//            middle to each of the region's corners (the field changes sign on it), the region's part of
//            each face triangulated between these and the vertices of the edges.
//
// Why the mesh of any sign pattern with any decisions is a closed, oriented 2-manifold:
// (1) A segment lies on one face, is used by the two cells of that face, and they run along it in opposite
//     directions. No other two vertices of edges of one face are joined.
// (2) A diagonal joins vertices of edges that share no face, or has an end inside the cell: no other cell can have
//     it. Within its surface it has two triangles; surfaces of one cell share no vertex.
// (3) Around a lattice edge lie four cells and four faces; each cell has one loop through the edge's vertex,
//     so the triangles at the vertex are four sectors joined at four segments: one fan. A vertex on a ray is inside
//     its surface.
// A surface drawn radially does not meet itself: seen from the middle no two of its triangles overlap.
//
// Deciding by the field's sign in the middle of a face or a cell is the asymptotic decider's purpose (Nielson and Hamann
// 1991; Chernyaev's MC33 1995 for the middle) for a function that is no trilinear interpolant and can be asked there.
// Tables typed in by hand (Lorensen and Cline 1987) join ambiguous faces inconsistently and leave holes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace isowave {

constexpr int kCellEdges = 12;
constexpr int kCellCorners = 8;
// Names of a cell's vertices: edge e is e; the one on the ray from the middle to corner c is kCellEdges + c.
constexpr int kCellVertices = kCellEdges + kCellCorners;

// Where edge e begins (its corner with coordinate 0 on its own axis).
struct CellEdge {
    std::uint8_t axis, x, y, z;
};

struct CellCase {
    std::vector<std::array<std::uint8_t, 3>> triangles;
    std::vector<std::vector<std::uint8_t>> loops;  // of edges
    std::uint8_t rays = 0;                         // bit c: the ray to corner c has a vertex
};

// What the field says where the signs of a cell's corners leave a choice.
struct CellDecision {
    std::uint8_t joined = 0;  // bit f: the inside corners of the ambiguous face f are joined
    bool middleInside = false;
};

class CellTable {
  public:
    CellTable();

    const CellEdge& edge(int e) const { return edges_[static_cast<std::size_t>(e)]; }
    // Bit f: face f has two opposite inside corners and two outside.
    unsigned ambiguousFaces(unsigned pattern) const { return ambiguous_[pattern]; }
    // Whether at() gives the same case for every decision.
    bool isPlain(unsigned pattern) const { return cases_[pattern].size() == 1; }
    // Whether the sign of the middle matters, too, once the faces are decided.
    bool needsMiddle(unsigned pattern, unsigned joined) const {
        return !isPlain(pattern) && needsMiddle_[pattern][compressed(pattern, joined)];
    }
    const CellCase& plain(unsigned pattern) const { return cases_[pattern].front(); }
    const CellCase& at(unsigned pattern, const CellDecision& decision) const {
        if (isPlain(pattern)) return plain(pattern);
        return cases_[pattern][2 * compressed(pattern, decision.joined) + decision.middleInside];
    }

  private:
    // The bits of `joined` at the pattern's ambiguous faces, side by side.
    std::size_t compressed(unsigned pattern, unsigned joined) const;
    void add(unsigned pattern);

    std::array<CellEdge, kCellEdges> edges_{};
    std::array<std::uint8_t, 256> ambiguous_{};
    std::array<std::vector<CellCase>, 256> cases_;  // one, or 2 compressed + middleInside
    std::array<std::vector<bool>, 256> needsMiddle_;
};

// Made once, never changed; safe from any thread.
const CellTable& cellTable();

// Bit f is set when edge e lies on face f.
unsigned facesOfEdge(int e);

// The four corners of a face, counter-clockwise seen from outside the cell.
std::array<int, 4> cornersOfFace(int face);

}  // namespace isowave
