// The edges of a lattice's voxels, which need be no cubes; world units.
#pragma once

#include <algorithm>

#include "volume/vdb.h"

namespace isowave::lod {

inline double shortestVoxel(const openvdb::math::Transform& lattice) {
    const openvdb::Vec3d edges = lattice.voxelSize();
    return std::min({edges.x(), edges.y(), edges.z()});
}
inline double longestVoxel(const openvdb::math::Transform& lattice) {
    const openvdb::Vec3d edges = lattice.voxelSize();
    return std::max({edges.x(), edges.y(), edges.z()});
}

}  // namespace isowave::lod
