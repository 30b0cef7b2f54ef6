#include "volume/linear_transform.h"

#include <fmt/format.h>

#include <cmath>

#include "isowave/error.h"

namespace isowave {
namespace {

// axes: rows, one an axis of the lattice.
void refuseTinyVoxels(const openvdb::math::Mat3d& axes, const std::string& object) {
    // OpenVDB's own constant: ScaleMap, AffineMap::updateAcceleration. A little more, for its roundoff.
    constexpr double smallest = 1.001 * 3e-15;
    const double volume = std::abs(axes.det());
    if (std::isfinite(volume) && volume > smallest) return;
    throw InputError(
        object,
        fmt::format("its voxels of {:g} x {:g} x {:g} have a volume of {:g}, expected more than 3e-15; give "
                    "all lengths in a smaller unit, such as micrometres for metres",
                    axes.row(0).length(), axes.row(1).length(), axes.row(2).length(), volume));
}

}  // namespace

openvdb::math::Mat4d matrixOf(const AffineTransform& indexToWorld) {
    const auto& [x, y, z] = indexToWorld.axis;
    const auto& o = indexToWorld.origin;
    return {x[0], x[1], x[2], 0., y[0], y[1], y[2], 0., z[0], z[1], z[2], 0., o[0], o[1], o[2], 1.};
}

openvdb::math::Transform::Ptr linearTransform(const openvdb::math::Mat4d& indexToWorld,
                                              const std::string& object) {
    refuseTinyVoxels(indexToWorld.getMat3(), object);
    return openvdb::math::Transform::createLinearTransform(indexToWorld);
}

openvdb::math::Transform::Ptr linearTransform(const AffineTransform& indexToWorld,
                                              const std::string& object) {
    return linearTransform(matrixOf(indexToWorld), object);
}

openvdb::math::Transform::Ptr linearTransform(double voxel, const std::string& object) {
    refuseTinyVoxels(openvdb::math::Mat3d::identity() * voxel, object);
    return openvdb::math::Transform::createLinearTransform(voxel);
}

}  // namespace isowave
