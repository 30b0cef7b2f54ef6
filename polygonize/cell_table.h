// Marching cubes' 256 cases, generated from one rule instead of typed in.
//
// A cell is the cube between 8 lattice points. Corner c = x + 2y + 4z with x, y, z in {0, 1}; bit c of a
// pattern says that corner c is inside. Edge e = 4a + k runs along axis a (0 x, 1 y, 2 z) from the corner
// whose coordinates on the axes a+1, a+2 (cyclic) are k & 1, k >> 1. An edge whose ends differ carries one
// vertex.
//
//   faces    On every face the inside corners fall into runs (going round the face), and each run is cut off
//            by one segment. A face with two opposite inside corners has two runs: the inside is separated
//            there. This looks at the face's own four signs, so the two cells that share it agree.
//   loops    A vertex lies on two faces of the cell, entered on one and left on the other: segments close up
//            into loops, directed so that they run counter-clockwise seen from outside the solid.
//   filling  A loop is triangulated without any diagonal that has both ends on one face, the shortest diagonals
//            first. All loops of all 256 cases allow it (they have 3 to 7 vertices): no case needs a vertex
//            in the middle of a cell. Complementing the signs shows the same for the other rule, joining the
//            inside.
//
// Why the mesh of any sign pattern is a closed, oriented 2-manifold:
// (1) A segment lies on one face, is used by the two cells of that face, and they run along it in opposite
//     directions. No other two vertices of a face are joined: diagonals never lie in a face.
// (2) A diagonal joins vertices of one loop of one cell that share no face, so no other cell can have it;
// inside
//     the loop's triangulation it has two triangles.
// (3) Around a lattice edge lie four cells and four faces; each cell has one loop through the edge's vertex,
// so
//     the triangles at the vertex are four sectors joined at four segments: one fan.
//
// Asymptotic deciders (Nielson and Hamann 1991; Chernyaev's MC33 1995) choose between separated and joined by
// the face's values and follow the trilinear interpolant's topology. Left out: the function here is no
// trilinear interpolant, and one rule for all cells keeps the solid's connection of lattice points (by edges)
// the same at every level. Tables typed in by hand (Lorensen and Cline 1987) join ambiguous faces
// inconsistently and leave holes.
#pragma once

#include <array>
#include <cstdint>

namespace isowave {

constexpr int kCellEdges = 12;
constexpr int kMaxCellTriangles = 5;
constexpr int kMaxCellLoops = 4;  // four separated corners

// Where edge e begins (its corner with coordinate 0 on its own axis).
struct CellEdge {
    std::uint8_t axis, x, y, z;
};

struct CellCase {
    std::uint8_t triangleCount = 0;
    std::array<std::array<std::uint8_t, 3>, kMaxCellTriangles> triangles{};  // edges 0..11
    // The loops, one after the other: how many edges each has, and their edges.
    std::uint8_t loopCount = 0;
    std::array<std::uint8_t, kMaxCellLoops> loopLength{};
    std::array<std::uint8_t, kCellEdges> loopEdges{};
};

struct CellTable {
    std::array<CellEdge, kCellEdges> edges{};
    std::array<CellCase, 256> cases{};
};

// Made once, never changed; safe from any thread.
const CellTable& cellTable();

// Bit f is set when edge e lies on face f; face 2a is the cell's low face on axis a, 2a + 1 the high one.
unsigned facesOfEdge(int e);

}  // namespace isowave
