// From inside and outside alone to a field without stairs that holds as much as the voxels do.
//
// The unknowns are the values v of F at the lattice points, so the mask's sign is a bound on one unknown. Among all
// values within half a voxel of (distance to the nearest lattice point of the other side) - 1/2, those of the least
// energy are taken (volume/fit/mask_energy.h), moved block by block so that each block of 8^3 voxels has as much inside
// as the mask (volume/fit/mask_volume.h), and interpolated.
#pragma once

#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/fit/repair.h"
#include "volume/fit/report.h"

namespace isowave {

struct MaskFitOptions {
    // Of projected gradient. 30: normals 1.3 times as far off, a sheet of one voxel loses 7 %; 100: 0.85 times.
    int passes = 60;
    double K = 1.0;  // 4 voxels, as fitDistance has it by default
    int mostRepairPasses = kMostRepairPasses;
};

// Of K, what the repair asks of s F.
inline constexpr double kMaskFloor = fitting::kDistanceFloor / 4;

// For masks and labels. All lengths are in voxels along the lattice's axes, whatever the voxels' spacing: volumes and
// planes do not depend on it. The same field, to the bit, for any number of threads.
BSplineField fitMask(const NodeCollection& nodes, const MaskFitOptions& options = {},
                     FitReport* report = nullptr, const Progress& progress = {});

// The same of a part, as fitDistancePart() in volume/fit.h is one, for options.passes = 60.
//
// How far the input reaches beyond the box: kMaskReach, and one for each pass of the repair. Every pass is local, so that the chain ends,
// from the box outwards, `|` being to the next leaf: the repair and its signs 3, control points that interpolate 5, three times the
// signs between lattice points 2 and their control points 5: 29 | three shifts one after the other, of v from leaves two away, their
// control points 2, and 5 again: 23 | each; ten passes, 2 each: 20 | a shift 23, ten passes: 43 | a shift 23, forty passes 80, the filter
// at the start 4, distances 4: 287 |.
inline constexpr int kMaskReach = 288;
BSplineField fitMaskPart(const NodeCollection& nodes, const MaskFitOptions& options,
                         const openvdb::CoordBBox& box, fitting::PartRepair& repair,
                         const Progress& progress = {});

}  // namespace isowave
