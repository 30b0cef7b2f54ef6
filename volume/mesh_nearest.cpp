#include "volume/mesh_nearest.h"

#include <openvdb/math/Proximity.h>

#include <algorithm>
#include <cassert>
#include <utility>

namespace isowave {
namespace {

using openvdb::Vec3d;

double squaredDistanceTo(const openvdb::BBoxd& box, const Vec3d& point) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double beyond = std::max({box.min()[axis] - point[axis], point[axis] - box.max()[axis], 0.0});
        sum += beyond * beyond;
    }
    return sum;
}

}  // namespace

TriangleHierarchy::TriangleHierarchy(const std::vector<Vec3d>& points, const std::vector<Triangle>& triangles)
    : tree_(triangles.size(), kInLeaf) {
    assert(!triangles.empty());
    corners_.reserve(triangles.size());
    for (const Triangle& t : triangles) corners_.push_back({points[t[0]], points[t[1]], points[t[2]]});
    boxes_.resize(tree_.boxCount());
    tree_.build(
        tree_.root(), [this](const Range& range) { divide(range); },
        [this](const Range& range) { bound(range); });
}

void TriangleHierarchy::divide(const Range& range) {
    const auto tripledCentre = [](const Corners& c) { return c[0] + c[1] + c[2]; };
    openvdb::BBoxd centres;
    for (std::size_t i = range.begin; i < range.end; ++i) centres.expand(tripledCentre(corners_[i]));
    const auto axis = static_cast<int>(centres.maxExtent());
    const auto first = corners_.begin();
    std::nth_element(first + std::ptrdiff_t(range.begin), first + std::ptrdiff_t(range.middle()),
                     first + std::ptrdiff_t(range.end), [axis](const Corners& a, const Corners& b) {
                         return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
                     });
}

void TriangleHierarchy::bound(const Range& range) {
    openvdb::BBoxd& box = boxes_[range.box];
    if (!tree_.isLeaf(range)) {
        box = boxes_[range.left().box];
        box.expand(boxes_[range.right().box]);
        return;
    }
    for (std::size_t i = range.begin; i < range.end; ++i)
        for (const Vec3d& corner : corners_[i]) box.expand(corner);
}

Vec3d TriangleHierarchy::footOn(std::int64_t triangle, const Vec3d& point) const {
    const Corners& c = corners_[std::size_t(triangle)];
    Vec3d barycentric;
    return openvdb::math::closestPointOnTriangleToPoint(c[0], c[1], c[2], point, barycentric);
}

Vec3d TriangleHierarchy::areaNormal(std::int64_t triangle) const {
    const Corners& c = corners_[std::size_t(triangle)];
    return (c[1] - c[0]).cross(c[2] - c[0]);
}

TriangleHierarchy::Nearest TriangleHierarchy::distanceTo(std::int64_t triangle, const Vec3d& point) const {
    return {(footOn(triangle, point) - point).lengthSqr(), triangle};
}

TriangleHierarchy::Nearest TriangleHierarchy::nearest(const Vec3d& point, Nearest best) const {
    tree_.nearestFirst(
        best.squared, [&](std::size_t box) { return squaredDistanceTo(boxes_[box], point); },
        [&](const Range& leaf) {
            for (std::size_t i = leaf.begin; i < leaf.end; ++i) {
                const Nearest found = distanceTo(std::int64_t(i), point);
                if (found.squared < best.squared) best = found;
            }
        });
    return best;
}

}  // namespace isowave
