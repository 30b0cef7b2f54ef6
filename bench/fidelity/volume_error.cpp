#include "volume_error.h"

#include <openvdb/tools/Interpolation.h>

#include <algorithm>

#include "polygonize/topology.h"
#include "simplify/distance.h"

namespace isowave::bench {
namespace {

using openvdb::Vec3d;

struct Facet {
    Vec3d middle, normal;  // unit, outwards
    double area;
};

Facet facetOf(const TriangleMesh& mesh, const Triangle& t) {
    const Vec3d a(mesh.points[t[0]].data()), b(mesh.points[t[1]].data()), c(mesh.points[t[2]].data());
    Vec3d normal = (b - a).cross(c - a);
    const double twice = normal.length();
    if (twice > 0) normal /= twice;
    return {(a + b + c) / 3, normal, twice / 2};
}

}  // namespace

std::vector<double> halfThickness(const FidelitySolid& solid) {
    constexpr double kStride = 0.25;
    // The walk ends where it has come as far from the surface as it will: the middle of a wall is behind it, or it no
    // longer goes straight away from the surface. Distances between lattice points are short by up to about so much.
    constexpr double kShort = 0.5, kStraight = 0.6;
    std::vector<double> half;
    half.reserve(solid.truth.triangles.size());
    const auto distance = solid.distance->getConstAccessor();
    for (const Triangle& t : solid.truth.triangles) {
        const Facet facet = facetOf(solid.truth, t);
        double deepest = 0;
        for (double walked = kStride; walked < kWide; walked += kStride) {
            const double depth =
                -openvdb::tools::BoxSampler::sample(distance, facet.middle - walked * facet.normal);
            if (depth < deepest - kShort / 5 || depth < kStraight * walked - kShort) break;
            deepest = std::max(deepest, depth);
        }
        half.push_back(deepest);
    }
    return half;
}

VolumeByThickness volumeByThickness(const FidelitySolid& solid, const std::vector<double>& half,
                                    const BSplineField& level, const TriangleMesh& mesh) {
    const DistanceTarget surface(mesh);
    const double voxel = level.transform().voxelSize()[0];
    const MeshTopology whole = topologyOf(solid.truth);
    VolumeByThickness result;
    for (std::size_t i = 0; i < half.size(); ++i) {
        const Facet facet = facetOf(solid.truth, solid.truth.triangles[i]);
        const auto& limits = VolumeByThickness::kThickness;
        const auto bin = static_cast<std::size_t>(
            std::upper_bound(limits.begin(), limits.end(), 2 * half[i] / voxel) - limits.begin());
        const double area = facet.area / whole.area;
        result.area[bin] += area;
        const double moved = surface.distance({facet.middle[0], facet.middle[1], facet.middle[2]});
        if (moved > voxel) {
            result.leftOut += area;
            continue;
        }
        const bool grown = evaluate(level, level.transform().worldToIndex(facet.middle)) < 0;
        result.gain[bin] += (grown ? moved : -moved) * facet.area / whole.volume;
    }
    return result;
}

}  // namespace isowave::bench
