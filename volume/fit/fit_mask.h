// From inside and outside alone to a field without stairs that holds as much as the voxels do.
//
// The unknowns are the values v of F at the lattice points, so the mask's sign is a bound on one unknown. Among all
// values within half a voxel of (distance to the nearest lattice point of the other side) - 1/2, those of the least
// energy are taken (volume/fit/mask_energy.h), moved block by block so that each block of 8^3 voxels has as much inside
// as the mask (volume/fit/mask_volume.h), and interpolated.
#pragma once

#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/fit/report.h"

namespace isowave {

struct MaskFitOptions {
    // Of projected gradient. 30: normals 1.3 times as far off, a sheet of one voxel loses 7 %; 100: 0.85 times.
    int passes = 60;
    double K = 1.0;  // 4 voxels, as fitDistance has it by default
    int mostRepairPasses = kMostRepairPasses;
};

// For masks and labels. All lengths are in voxels along the lattice's axes, whatever the voxels' spacing: volumes and
// planes do not depend on it. The same field, to the bit, for any number of threads.
BSplineField fitMask(const NodeCollection& nodes, const MaskFitOptions& options = {},
                     FitReport* report = nullptr, const Progress& progress = {});

}  // namespace isowave
