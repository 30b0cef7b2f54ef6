// Transforms from lattice to world, as OpenVDB holds them.
#pragma once

#include <string>

#include "isowave/image.h"
#include "volume/vdb.h"

namespace isowave {

// As OpenVDB has it: rows are the images of the axes, the last one the origin.
openvdb::math::Mat4d matrixOf(const AffineTransform& indexToWorld);

// indexToWorld: row vectors, world = (i, j, k, 1) * M. OpenVDB refuses a matrix whose voxel's volume is below
// 3e-15 (cubes of 1.44e-5), which is small only if the unit is large. Throws InputError then, and where the
// axes are parallel or a value is not finite, with the spacing found and what to do.
// object: as in InputError ("image", "mesh").
openvdb::math::Transform::Ptr linearTransform(const openvdb::math::Mat4d& indexToWorld,
                                              const std::string& object);
openvdb::math::Transform::Ptr linearTransform(const AffineTransform& indexToWorld, const std::string& object);
// Cubes of edge `voxel`.
openvdb::math::Transform::Ptr linearTransform(double voxel, const std::string& object);

}  // namespace isowave
