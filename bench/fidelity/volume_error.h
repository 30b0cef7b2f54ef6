// What the error of a level's volume consists of: of the field itself, where the solid is thin and where it is thick, and of
// the triangles.
#pragma once

#include <array>
#include <vector>

#include "solids.h"
#include "volume/field.h"

namespace isowave::bench {

// Half the thickness of the solid below each triangle of its surface, in voxels: how deep the distance goes from there along the
// normal. At most kWide.
std::vector<double> halfThickness(const FidelitySolid& solid);

// The surface by thickness, in voxels of the level, and what the level adds to the volume there: area times signed distance to
// the level's surface, which is the volume to first order. Places that are farther from it than a voxel of the level are left
// out of `gain`.
struct VolumeByThickness {
    static constexpr std::array kThickness{0.5, 1.0, 2.0};  // bins: below the first, ..., from the last
    std::array<double, kThickness.size() + 1> area{},
        gain{};          // shares of the surface's area and of the solid's volume
    double leftOut = 0;  // share of the area
};
// mesh: of the level's zero set, so fine that its own error does not count. half: halfThickness() of the solid.
VolumeByThickness volumeByThickness(const FidelitySolid& solid, const std::vector<double>& half,
                                    const BSplineField& level, const TriangleMesh& mesh);

}  // namespace isowave::bench
