// Better triangles on the same surface: vertices slide along the zero set.
#pragma once

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "polygonize/zero_set.h"

namespace isowave {

// Each round moves every vertex towards the middle of its neighbours, within the tangent plane, then back
// onto the zero set. A vertex stays where it is when the move would
//   - make the smallest angle of its triangles smaller than it is,
//   - turn one of its triangles by more than a right angle, or against the surface's normal at the vertex,
//   - leave its neighbourhood: farther than half its longest edge, or onto another sheet.
// A shorter move is tried then.
// So triangles only get better, round by round, and none flips. Vertices are taken by colour, no two of a
// colour sharing an edge: the result is the same to the bit for any number of threads.
// (1) Every vertex that moved is on the zero set to kOnSurface voxels; its normal is the gradient there.
// (2) Triangles are the same ones, so closed, oriented and 2-manifold are what they were. Vertices on an open
// edge
//     stay.
// (3) The smallest angle of the mesh does not fall.
void relax(TriangleMesh& mesh, const ZeroSet& surface, int rounds, const Progress& progress = {});

constexpr double kOnSurface = 1e-8;  // ten times ZeroSet::kSettled

// The smallest angle of all triangles, in degrees; 180 without triangles.
double smallestAngle(const TriangleMesh& mesh);

}  // namespace isowave
