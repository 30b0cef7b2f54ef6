// The last pass of every fit: control points change until every lattice point of I has the input's sign by a margin.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/progress.h"
#include "volume/field.h"
#include "volume/fit/report.h"

namespace isowave::fitting {

// result: what is known so far; report: where all of it goes, nullptr if nobody asks for it. Counting takes a
// quarter of a fit.
// floor: of K, what s F has to reach; target: what it is moved to.
void finish(BSplineField& field, double floor, double target, int mostPasses, FitReport result,
            FitReport* report, const Progress& progress);

// What the repair does in a part of a field.
struct PartRepair {
    // Control points in the box that each pass changes, the last one that was looked at too: 0 where all of the part had its sign.
    std::vector<std::int64_t> repaired;
    std::int64_t latticePoints = 0, disagreeing = 0;  // as FitReport has them, in the box
};

// The repair of a part, at most so many passes. A pass moves by what lies one lattice point beside, so in `box` values are those of
// the whole field's after as many passes, where the part reaches that far beyond it, and one more.
PartRepair finishPart(BSplineField& part, double floor, double target, int mostPasses,
                      const openvdb::CoordBBox& box, const Progress& progress);

// A fit to distances is right to a hundredth of a voxel where it disagrees at all, so it is moved as little as
// will do: floor and target in voxels.
inline constexpr double kDistanceFloor = 1e-4, kDistanceTarget = 2e-4;

// The binary fit's, of K. E§2 asks for the sign only; the margin keeps every node stabbed when the field is next filtered or stored.
inline constexpr double kBinaryFloor = 0.05, kBinaryTarget = 0.1;

}  // namespace isowave::fitting
