// The last pass of every fit: control points change until every lattice point of I has the input's sign by a margin.
#pragma once

#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/fit/report.h"

namespace isowave::fitting {

// result: what is known so far; report: where all of it goes, nullptr if nobody asks for it. Counting takes a
// quarter of a fit.
// floor: of K, what s F has to reach; target: what it is moved to.
void finish(BSplineField& field, double floor, double target, int mostPasses, FitReport result,
            FitReport* report, const Progress& progress);

// A fit to distances is right to a hundredth of a voxel where it disagrees at all, so it is moved as little as
// will do: floor and target in voxels.
inline constexpr double kDistanceFloor = 1e-4, kDistanceTarget = 2e-4;

}  // namespace isowave::fitting
