#include "volume/mesh_nearest.h"

#include <openvdb/math/Proximity.h>
#include <tbb/parallel_invoke.h>

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

TriangleHierarchy::TriangleHierarchy(const std::vector<Vec3d>& points,
                                     const std::vector<Triangle>& triangles) {
    assert(!triangles.empty());
    corners_.reserve(triangles.size());
    for (const Triangle& t : triangles) corners_.push_back({points[t[0]], points[t[1]], points[t[2]]});
    std::size_t leaves = 1;
    while (leaves * kInLeaf < corners_.size()) leaves *= 2;
    firstLeaf_ = leaves - 1;
    boxes_.resize(2 * leaves - 1);
    build({0, 0, corners_.size()});
}

void TriangleHierarchy::build(const Range& range) {
    openvdb::BBoxd box, centres;  // centres: three times the triangles' centres
    for (std::size_t i = range.begin; i < range.end; ++i) {
        for (const Vec3d& corner : corners_[i]) box.expand(corner);
        centres.expand(corners_[i][0] + corners_[i][1] + corners_[i][2]);
    }
    boxes_[range.node] = box;
    if (isLeaf(range)) return;
    const auto axis = static_cast<int>(centres.maxExtent());
    const auto first = corners_.begin();
    std::nth_element(first + std::ptrdiff_t(range.begin), first + std::ptrdiff_t(range.middle()),
                     first + std::ptrdiff_t(range.end), [axis](const Corners& a, const Corners& b) {
                         return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
                     });
    if (range.end - range.begin > 4096) {
        tbb::parallel_invoke([&] { build(range.left()); }, [&] { build(range.right()); });
    } else {
        build(range.left());
        build(range.right());
    }
}

TriangleHierarchy::Nearest TriangleHierarchy::distanceTo(std::int64_t triangle, const Vec3d& point) const {
    const Corners& c = corners_[std::size_t(triangle)];
    Vec3d barycentric;
    const Vec3d closest = openvdb::math::closestPointOnTriangleToPoint(c[0], c[1], c[2], point, barycentric);
    return {(closest - point).lengthSqr(), triangle};
}

TriangleHierarchy::Nearest TriangleHierarchy::nearest(const Vec3d& point, Nearest best) const {
    // invariant: nodes on the stack and below `at` are all that may hold a nearer triangle. One node a level
    // waits.
    std::array<std::pair<Range, double>, 64> stack;
    std::size_t waiting = 0;
    Range at{0, 0, corners_.size()};
    double distance = squaredDistanceTo(boxes_[0], point);
    while (true) {
        if (distance < best.squared) {
            if (!isLeaf(at)) {
                Range near = at.left(), far = at.right();
                double toNear = squaredDistanceTo(boxes_[near.node], point);
                double toFar = squaredDistanceTo(boxes_[far.node], point);
                if (toFar < toNear) {
                    std::swap(near, far);
                    std::swap(toNear, toFar);
                }
                if (toFar < best.squared) stack[waiting++] = {far, toFar};
                at = near;
                distance = toNear;
                continue;
            }
            for (std::size_t i = at.begin; i < at.end; ++i) {
                const Nearest found = distanceTo(std::int64_t(i), point);
                if (found.squared < best.squared) best = found;
            }
        }
        if (waiting == 0) return best;
        std::tie(at, distance) = stack[--waiting];
    }
}

}  // namespace isowave
