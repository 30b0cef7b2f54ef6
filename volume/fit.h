// From signs or distances to a B-spline field whose sign agrees with the input at every lattice point near
// the surface. One function each, and volume/fit/fit_mask.h has a third; see docs/volume.md for the passes and what was
// measured.
#pragma once

#include <cstdint>
#include <functional>

#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/fit/repair.h"
#include "volume/fit/report.h"

namespace isowave {

// Both fits move the lattice's origin, by a multiple of 8 on each axis, where control points would lie below
// -1, and shift the transform the other way: every field then ends at a single node. World coordinates do not
// change.

struct BinaryFitOptions {
    int passes = 3;  // Laplacian passes; 3 smooths staircases, 0 leaves the ±K weights
    double K = 1.0;
    int mostRepairPasses = kMostRepairPasses;
};

struct DistanceFitOptions {
    double halfWidth = 4.0;  // w in voxels: the distance is clamped to ±w and scaled so that ±w becomes ±K
    double band = 2.0;       // b in voxels: nodes with a corner nearer than b are kept. 0 < b <= w
    double K = 1.0;
    int mostRepairPasses = kMostRepairPasses;
    // Called before the repair, to change control points of I, and the shape's signs where they are meant to
    // follow (fitWalls() of volume/walls/wall_fit.h). Lattice point i of the distances is i + shift of the field.
    std::function<void(BSplineField& field, const openvdb::Coord& shift)> adjust = {};
};

// E§2: ±K weights on I (G dilated by {-1,0,1,2}), `passes` of the discrete Laplacian filter on I, then the
// repair.
BSplineField fitBinary(const NodeCollection& nodes, const BinaryFitOptions& options = {},
                       FitReport* report = nullptr, const Progress& progress = {});

// Signed distance -> field by quasi-interpolation c = (8v_i - v_{i-1} - v_{i+1})/6 on each axis, then the
// repair.
// distance: signed distance in voxels (index space), negative inside, valid and active at least where
// |distance| < halfWidth; inactive voxels and tiles hold any value of the right sign with magnitude >=
// halfWidth (a level set of that half-width is exactly this). nodes of G: those with a corner where
// |distance| < band; a node whose corner signs differ is always kept.
BSplineField fitDistance(const openvdb::FloatGrid& distance, const DistanceFitOptions& options = {},
                         FitReport* report = nullptr, const Progress& progress = {});
// The same where nobody wants the distances afterwards: they go as control points are made. options.adjust is not called.
BSplineField fitDistance(openvdb::FloatGrid::Ptr&& distance, const DistanceFitOptions& options = {},
                         FitReport* report = nullptr, const Progress& progress = {});

// The same for a part of a solid, whose input is known some way beyond a box; in the box the result is the whole
// solid's, but for the lattice's origin, which is not moved: what a part does not know.
//
// How far beyond, on each side: kFitReach lattice points, and one for each pass of the repair. The chain, from the box outwards: the
// signs that are counted, 1, of control points 1, that a pass moves by those 1 beside them. What is known there takes distances 3 away,
// quasi-interpolation 1; a distance takes the crossings 4 away, whose edges and slopes end 2 farther: 11. (Binary: smoothing 3, known
// 2, nodes 1: 8.) Cuts lie between leaves, and ends of the input must, too: to the next multiple of 8.
inline constexpr int kFitReach = 16;
// options.mostRepairPasses: as many as the input reaches beyond the box, less kFitReach. options.adjust is not called.
// repair: what it did in the box, which is in whole leaves.
BSplineField fitBinaryPart(const NodeCollection& nodes, const BinaryFitOptions& options,
                           const openvdb::CoordBBox& box, fitting::PartRepair& repair,
                           const Progress& progress = {});
BSplineField fitDistancePart(openvdb::FloatGrid::Ptr&& distance, const DistanceFitOptions& options,
                             const openvdb::CoordBBox& box, fitting::PartRepair& repair,
                             const Progress& progress = {});

}  // namespace isowave
