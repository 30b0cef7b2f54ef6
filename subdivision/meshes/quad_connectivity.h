// Finds the coarse mesh inside a mesh of quads that Catmull-Clark's rules, or details on top of them, have made.
//
// Every fine face has the corners V, E, F, E: the point of a vertex, of an edge, of a face, of an edge. One such corner
// fixes the others of its face, and those of the faces next to it, so a component has at most four *labellings*. A
// labelling is good when
//   an E inside has four faces, one on the boundary two, between the V's;     an F lies inside;
//   creases run along V-E-V;     pinned vertices are V's;
//   the coarse mesh is an oriented 2-manifold without double edges (polygon_mesh.h, defects()).
// Of several good labellings, in each component by itself, the one taken is
//   1. one whose coarse mesh can be made coarser most often, up to the levels asked for;
//   2. then the one with the least details (variant refined), in the sum of their squares: so an exact subdivision is
//      found again, even of an octahedron, whose faces would do as well for a cube. Sums that exceed the least by no
//      more than its kSameDetails-th part count as equal;
//   3. then the one in which the vertex of the component's first face with the lowest number is a V.
// The coarse mesh has its vertices in the order of the V's and its faces in that of the F's; a face starts at the V of
// its first fine face. So what `subdivided` made comes back in its own order.
// Linear: the labellings of one level cost four passes, those of the next one a quarter of that.
#pragma once

#include "subdivision/meshes/mesh_scheme.h"

namespace isowave::subdivision {

inline constexpr double kSameDetails = 1e-6;

// For MeshScheme::recover. InputError: "no Catmull-Clark connectivity"; which vertex or face contradicts the labelling
// that has the fewest contradictions; how many levels are possible.
std::vector<Coarsening> recoverQuads(const PolygonMesh& fine, int levels, const Progress& progress);

}  // namespace isowave::subdivision
