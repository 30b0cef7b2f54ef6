#include <algorithm>
#include <cassert>
#include <cmath>

#include "volume/distance.h"

namespace isowave {
namespace {

struct Bounds {
    Point low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    double extent(int axis) const { return high[axis] - low[axis]; }
};

Bounds boundsOf(const TriangleMesh& mesh) {
    Bounds bounds;
    for (const Triangle& triangle : mesh.triangles) {
        for (const auto corner : triangle) {
            for (int axis = 0; axis < 3; ++axis) {
                bounds.low[axis] = std::min(bounds.low[axis], mesh.points[corner][axis]);
                bounds.high[axis] = std::max(bounds.high[axis], mesh.points[corner][axis]);
            }
        }
    }
    return bounds;
}

double areaOf(const TriangleMesh& mesh) {
    double twice = 0.0;
    for (const Triangle& t : mesh.triangles) {
        const openvdb::Vec3d a(mesh.points[t[0]].data()), b(mesh.points[t[1]].data()),
            c(mesh.points[t[2]].data());
        twice += (b - a).cross(c - a).length();
    }
    return twice / 2;
}

}  // namespace

double voxelForCount(const TriangleMesh& mesh, double voxels) {
    assert(voxels > 0 && !mesh.triangles.empty());
    const Bounds bounds = boundsOf(mesh);
    return std::max({bounds.extent(0), bounds.extent(1), bounds.extent(2)}) / voxels;
}

openvdb::math::Transform::Ptr transformForMesh(const TriangleMesh& mesh, double voxel) {
    assert(voxel > 0 && !mesh.triangles.empty());
    const double offset = (3.0 - std::sqrt(5.0)) / 2.0;
    const Bounds bounds = boundsOf(mesh);
    auto transform = openvdb::math::Transform::createLinearTransform(voxel);
    transform->postTranslate(openvdb::Vec3d(bounds.low.data()) - openvdb::Vec3d(offset * voxel));
    return transform;
}

double estimateBandVoxels(const TriangleMesh& mesh, double voxel, double halfWidth) {
    assert(voxel > 0 && halfWidth > 0 && !mesh.triangles.empty());
    const Bounds bounds = boundsOf(mesh);
    double box = 1.0;
    for (int axis = 0; axis < 3; ++axis) box *= bounds.extent(axis) / voxel + 2 * halfWidth;
    return std::min(box, areaOf(mesh) / (voxel * voxel) * 2 * halfWidth);
}

}  // namespace isowave
