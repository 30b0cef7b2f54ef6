// The mesh that a triangle mesh is the 1-to-4 refinement of, found from the fine triangles alone.
//
// In a refined mesh every vertex is either one that *remains* (it was a coarse vertex) or the *middle* of a coarse
// edge, and every triangle either lies at a remaining vertex or is the middle of a coarse triangle:
//
//          a               remaining: a, b, c          middles: x, y, z
//         / \              triangles: (a, x, z) at a, (b, y, x) at b, (c, z, y) at c, (x, y, z) in the middle
//        x---z
//       / \ / \            One triangle's part settles its neighbours' (passes below), so a connected piece has
//      b---y---c           four possible answers: the first triangle's three corners, or its middle.
//
// Passes: start -> spread -> count -> assemble.
//   start     the piece's vertex of lowest number, its neighbour of lowest number, and their triangle
//   spread    across every edge; stops where two parts meet that disagree, or where a middle would lie on the
//             boundary or would not have 6 triangles (3 on the boundary)
//   count     no two coarse triangles may share a directed edge, nor may one have a vertex twice
//   assemble  coarse vertices in the order of the fine ones, coarse triangles in the order of their middles
// The first of these answers that holds is taken: the vertex of lowest number remains; else its neighbour of lowest
// number does; else the third corner; else none of the three. (More than one holds only where no vertex inside has
// a valence other than 6: on tori, annuli and some open pieces. Programs write coarse vertices first, so the first
// answer gives back what they subdivided. Which answer is taken depends on the numbering of vertices, not on the order of
// triangles.)
//
// Linear in the number of triangles. Taubin, "Detecting and reconstructing subdivision connectivity" (The Visual
// Computer 18, 2002), looks at all four answers at once, as sheets of a covering; the result is the same.
#pragma once

#include <string>
#include <vector>

#include "isowave/progress.h"
#include "subdivision/meshes/mesh_scheme.h"
#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision {

// One level. Throws InputError naming the piece, and the vertex or triangle where the best answer fails; a face that
// is no triangle; a pinned vertex that would be the middle of an edge; creases, which no scheme for triangles takes.
// REQUIRES: defects(fine).empty().
Coarsening coarsenedTriangles(const PolygonMesh& fine);

// Throws InputError for a face that is no triangle and for creases.
void requireTriangles(const PolygonMesh& mesh);

// MeshScheme::recover for 1-to-4 refinement. Messages name vertices of `fine`, whatever the level.
std::vector<Coarsening> recoverTriangles(const PolygonMesh& fine, int levels, const Progress& progress);

// 1 to 4, in the order of mesh_scheme.h: the vertex on edge e gets number coarse.vertices() + e; the face of corner c
// starts at its vertex; then the middles, each starting at its triangle's first edge. Points are all 0.
// REQUIRES: triangles only.
PolygonMesh fineTriangles(const Adjacency& coarse);

}  // namespace isowave::subdivision
