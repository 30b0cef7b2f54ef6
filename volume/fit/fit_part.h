// The fits of volume/fit.h for a part of a solid, whose input is known some way beyond a box; in the box the result is the whole
// solid's, but for the lattice's origin, which is not moved: what a part does not know.
//
// How far beyond, on each side: kFitReach lattice points, and one for each pass of the repair. The chain, from the box outwards: the
// signs that are counted, 1, of control points 1, that a pass moves by those 1 beside them; quasi-interpolation 1 (smoothing 3);
// what is known 4, of distances that crossings 5 away give, in leaves of 8.
#pragma once

#include "volume/fit.h"
#include "volume/fit/repair.h"

namespace isowave {

inline constexpr int kFitReach = 24;

// options.mostRepairPasses: as many as the input reaches beyond the box, less kFitReach. options.adjust is not called.
// repair: what it did in the box, which is in whole leaves.
BSplineField fitBinaryPart(const NodeCollection& nodes, const BinaryFitOptions& options,
                           const openvdb::CoordBBox& box, fitting::PartRepair& repair,
                           const Progress& progress = {});
BSplineField fitDistancePart(const openvdb::FloatGrid& distance, const DistanceFitOptions& options,
                             const openvdb::CoordBBox& box, fitting::PartRepair& repair,
                             const Progress& progress = {});

}  // namespace isowave
