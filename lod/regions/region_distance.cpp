#include "lod/regions/region_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isowave/error.h"

namespace isowave::lod {

double distanceTo(const RegionBox& box, const openvdb::Vec3d& p) {
    double outside2 = 0, inside = -HUGE_VAL;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const double beyond = std::max(box.low[a] - p[axis], p[axis] - box.high[a]);
        inside = std::max(inside, beyond);
        outside2 += std::pow(std::max(0.0, beyond), 2);
    }
    return inside > 0 ? std::sqrt(outside2) : inside;
}

namespace {

// The lines of the lattice through a mesh take 4 bytes each.
void requireExtent(const std::vector<openvdb::Vec3d>& points, const RegionShape& shape) {
    openvdb::BBoxd box;
    for (const openvdb::Vec3d& p : points) box.expand(p);
    const double extent = box.extents()[box.maxExtent()];
    if (!(extent <= ShapeDistance::kLargest))
        throw InputError(
            shape.name,
            fmt::format("the mesh is {:.3g} voxels of level {} across, more than {:g}; is it in the "
                        "units of the solid? Give a smaller one, or a box",
                        extent, shape.level, ShapeDistance::kLargest));
}

}  // namespace

ShapeDistance::ShapeDistance(RegionShape shape, openvdb::math::Transform::ConstPtr lattice,
                             const Progress& progress)
    : shape_(std::move(shape)), lattice_(std::move(lattice)) {
    const auto* closed = std::get_if<RegionShape::Closed>(&shape_.where);
    if (!closed) return;
    std::vector<openvdb::Vec3d> points;
    points.reserve(closed->mesh.points.size());
    for (const Point& p : closed->mesh.points)
        points.push_back(lattice_->worldToIndex(openvdb::Vec3d(p[0], p[1], p[2])));
    requireExtent(points, shape_);
    lines_ = std::make_unique<const LatticeLines>(points, closed->mesh.triangles, closed->evenOdd, progress);
}

double ShapeDistance::at(const openvdb::Coord& point, double most) const {
    const openvdb::Vec3d world = lattice_->indexToWorld(point);
    if (const auto* box = std::get_if<FineRegion::Box>(&shape_.where))
        return distanceTo(*box, world) - shape_.within;
    const auto& closed = std::get<RegionShape::Closed>(shape_.where);
    const double farthest = most + shape_.within;
    // A bound that is not reached comes back as it is, and is beyond what was asked for.
    const double bound = 1.0001 * farthest;
    const double distance = std::sqrt(closed.nearest->nearest(world, {bound * bound, -1}).squared);
    return (lines_->inside(point) ? -distance : distance) - shape_.within;
}

openvdb::CoordBBox ShapeDistance::boxWithin(double distance) const {
    const PointBox bounds = shape_.bounds();
    openvdb::CoordBBox box;
    for (int corner = 0; corner < 8; ++corner) {
        openvdb::Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            constexpr double kFinite = 1e30;  // what is infinite would make NaN below
            p[axis] = std::clamp(corner >> axis & 1 ? bounds.high[a] + distance : bounds.low[a] - distance,
                                 -kFinite, kFinite);
        }
        // Far corners of a huge box: the lattice's own numbers end there.
        constexpr double kFarthest = 1 << 29;
        openvdb::Vec3d index = lattice_->worldToIndex(p);
        for (int axis = 0; axis < 3; ++axis) index[axis] = std::clamp(index[axis], -kFarthest, kFarthest);
        box.expand(openvdb::Coord::floor(index));
        box.expand(openvdb::Coord::ceil(index));
    }
    return box;
}

}  // namespace isowave::lod
