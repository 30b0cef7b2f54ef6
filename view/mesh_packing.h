// A triangle mesh in few bytes, which page/unpack.js takes apart again: about 2 bytes a triangle where the mesh is smooth.
//
// Triangles are walked from neighbour to neighbour, so that each but the first of a component has one corner left to say,
// c, behind the edge a -> b through which it is entered. d is the corner of the triangle on the other side of that edge.
//     kind of c     new: the next number;  before: the vertex before a on the rim of what was walked;
//                   behind: the vertex behind b there;  named: its number follows
//     exits         whether the walk goes on through b-c (first), and through c-a (kept on a stack)
// as in Rossignac, "Edgebreaker: connectivity compression for triangle meshes" (1999), whose L and R are `before` and
// `behind`. Where his rim is exact, ours is a table of one neighbour each side of a vertex, which is wrong where the rim meets
// itself; that costs a named vertex and nothing else. So any mesh will do, with handles, borders, and edges of three triangles.
// A new vertex is stored as its difference from a + b - d (Touma and Gotsman 1998), on a lattice of 65,536 steps along the
// longest side of the box around the mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "view/text_bytes.h"

namespace isowave::view {

inline constexpr int kSteps = 65535;  // of the lattice, along the longest side of the box

// The streams, one behind the other in `bytes`:
//   kinds       a byte a triangle: kind (new 0, before 1, behind 2, named 3) + 4 (through b-c) + 8 (through c-a); where c is
//               named also + 16 and + 32 where the walk has been on the other side of b-c and of c-a
//   positions   of x, y and z: low bytes, then high bytes, one a vertex, of the zigzagged difference modulo 2^16
//   names       varints: a and b of a component's first triangle, and each named c: 0 is the next new vertex, k the one that
//               is k below it
struct PackedMesh {
    Bytes bytes;
    std::int64_t vertices = 0;  // that a triangle uses
    std::int64_t triangles = 0;
    Point low{}, high{};  // world; the box around them; vertex = low + step * lattice
    double step = 1;  // world units; a coordinate is off by step/2 at most
    std::vector<std::uint32_t> order;  // of each packed vertex: its number in the mesh
};

// Triangles keep their orientation and may begin at another corner; they and the vertices change their order.
// REQUIRES: finite points; indices below points.size().
PackedMesh packed(const TriangleMesh& mesh);

// Numbers from 0 to `largest`, one a packed vertex, as differences from the one before, on 65,535 steps: low bytes, then high
// bytes. Off by largest/131070 at most. order: of the packed mesh.
Bytes packedValues(const std::vector<float>& ofVertex, const std::vector<std::uint32_t>& order, double largest);

}  // namespace isowave::view
