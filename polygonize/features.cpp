#include "polygonize/features.h"

#include <algorithm>
#include <cmath>

#include "base/point_box.h"
#include "polygonize/lattice_value.h"
#include "polygonize/persistence.h"
#include "volume/distance_mesh.h"
#include "volume/mesh_nearest.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// The lattice's box: what the mesh's box becomes, made larger by the reach and one point more, so that beyond
// it nothing is within reach.
CoordBBox boxOf(const PointBox& bounds, const openvdb::math::Transform& transform, int reach) {
    return {Coord::floor(transform.worldToIndex(Vec3d(bounds.low.data()))).offsetBy(-reach - 1),
            Coord::ceil(transform.worldToIndex(Vec3d(bounds.high.data()))).offsetBy(reach + 1)};
}

double pointsFor(const PointBox& bounds, double spacing, int reach) {
    double points = 1;
    for (int a = 0; a < 3; ++a) points *= bounds.extent(a) / spacing + 2 * (reach + 2);
    return points;
}

// Distances in lattice steps, on the box.
LatticeFunction denseDistance(const openvdb::FloatGrid& distance, const CoordBBox& box) {
    LatticeFunction d;
    d.size = box.dim();
    d.values.reserve(static_cast<std::size_t>(box.volume()));
    const auto accessor = distance.getConstAccessor();
    Coord at;
    for (at[0] = box.min()[0]; at[0] <= box.max()[0]; ++at[0])
        for (at[1] = box.min()[1]; at[1] <= box.max()[1]; ++at[1])
            for (at[2] = box.min()[2]; at[2] <= box.max()[2]; ++at[2])
                d.values.push_back(accessor.getValue(at));
    return d;
}

// A lattice point beside the middle of a part, a hole, a ring -> the middle, and its distance to the surface:
// the largest within the half diagonal of a voxel, which is how far the middle can be from the lattice. By
// steps along the axes, each shorter than the distance, so that none crosses the surface.
struct Middle {
    Vec3d at;  // index space
    double distance;
};

class MiddleFinder {
  public:
    MiddleFinder(const TriangleMesh& mesh, const openvdb::math::Transform& transform)
        : hierarchy_(indexPoints(mesh, transform), mesh.triangles) {}

    Middle near(const Vec3d& start) const {
        const double reach = std::sqrt(3.0) / 2;
        Middle best{start, distanceTo(start)};
        for (double step = 0.5; step > kFinest; step /= 2)
            for (bool better = true; better;) {
                better = false;
                for (int k = 0; k < 6; ++k) {
                    Vec3d at = best.at;
                    at[k / 2] += (k % 2 ? 1 : -1) * std::min(step, best.distance / 2);
                    if ((at - start).length() > reach) continue;
                    if (const double d = distanceTo(at); d > best.distance + kGain) {
                        best = {at, d};
                        better = true;
                    }
                }
            }
        return best;
    }

  private:
    static constexpr double kFinest = 0.03, kGain = 1e-3;  // steps of the lattice

    static std::vector<Vec3d> indexPoints(const TriangleMesh& mesh,
                                          const openvdb::math::Transform& transform) {
        std::vector<Vec3d> points;
        points.reserve(mesh.points.size());
        for (const Point& p : mesh.points) points.push_back(transform.worldToIndex(Vec3d(p[0], p[1], p[2])));
        return points;
    }
    double distanceTo(const Vec3d& at) const {
        return std::sqrt(hierarchy_.nearest(at, {std::numeric_limits<double>::max(), -1}).squared);
    }
    TriangleHierarchy hierarchy_;
};

}  // namespace

SolidFeatures featuresOf(const TriangleMesh& mesh, const FeatureOptions& options, const Progress& progress) {
    SolidFeatures features;
    const PointBox bounds = boxAround(mesh);
    features.spacing = options.spacing;
    constexpr double kCoarser = 1.05;
    while (pointsFor(bounds, features.spacing, options.reach) > options.mostPoints)
        features.spacing *= kCoarser;
    const auto transform = transformForMesh(mesh, features.spacing);
    const auto distance = distanceFromMesh(mesh, *transform, options.reach, false, progress);
    const CoordBBox box = boxOf(bounds, *transform, options.reach);
    const LatticeFunction d = denseDistance(*distance, box);
    // Clamped values are `reach`: just below it is as far as d is known.
    features.reach = options.reach * features.spacing;
    const float last = std::nextafter(static_cast<float>(options.reach), 0.0f);

    const MiddleFinder finder(mesh, *transform);
    const auto measure = [&](std::int64_t index, Point& place, double& radius) {
        const Middle middle = finder.near((box.min() + d.point(index)).asVec3d());
        const Vec3d p = transform->indexToWorld(middle.at);
        place = {p[0], p[1], p[2]};
        radius = middle.distance * features.spacing;
    };
    for (const PersistentClass& c : classesAt(d, 0, last, progress)) {
        progress.check();
        Feature f;
        measure(c.birthPoint, f.weakest, f.thinnest);
        f.core = f.weakest;
        f.radius = c.dimension == 0 ? f.thinnest : features.reach;
        f.beyondReach = c.dimension != 0 && c.deathPoint == PersistentClass::kNever;
        if (c.dimension != 0 && !f.beyondReach) measure(c.deathPoint, f.core, f.radius);
        (c.dimension == 0   ? features.parts
         : c.dimension == 1 ? features.handles
                            : features.cavities)
            .push_back(f);
    }
    for (auto* some : {&features.parts, &features.handles, &features.cavities})
        std::stable_sort(some->begin(), some->end(),
                         [](const Feature& a, const Feature& b) { return a.radius < b.radius; });
    return features;
}

SolidSurvival survivalOf(const SolidFeatures& features, const BSplineField& level, double iso,
                         const std::vector<PointBox>& removed) {
    const auto accessor = level.controlPoints->getConstUnsafeAccessor();
    const auto inside = [&](const Point& p) {
        return latticeInterpolated(accessor, level.transform().worldToIndex(Vec3d(p[0], p[1], p[2]))) < iso;
    };
    const auto isRemoved = [&](const Point& p) {
        return std::any_of(removed.begin(), removed.end(),
                           [&](const PointBox& box) { return box.contains(p); });
    };
    const auto take = [](Survival& s, const Feature& f, bool closed, bool torn) {
        if (closed) {
            ++s.closed;
            s.largestVanished = std::max(s.largestVanished.value_or(0), f.radius);
        } else if (torn) {
            ++s.torn;
        } else {
            ++s.survived;
            s.smallestSurviving = std::min(s.smallestSurviving.value_or(f.radius), f.radius);
        }
    };
    SolidSurvival survival;
    for (const Feature& f : features.parts)
        take(survival.parts, f, !inside(f.core) || isRemoved(f.core), false);
    const auto isClosed = [&](const Feature& f) { return !f.beyondReach && inside(f.core); };
    for (const Feature& f : features.handles)
        take(survival.handles, f, isClosed(f) || isRemoved(f.weakest), !inside(f.weakest));
    for (const Feature& f : features.cavities)
        take(survival.cavities, f, isClosed(f) || isRemoved(f.core), !inside(f.weakest));
    return survival;
}

}  // namespace isowave
