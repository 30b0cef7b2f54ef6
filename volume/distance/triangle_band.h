// The leaves of the band around a mesh, with exact distances: from a block around all of it down to leaves, each block with
// the triangles that can be nearest to its lattice points (volume/distance/triangle_lists.h).
#pragma once

#include <functional>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/distance/leaves.h"

namespace isowave {

// finish(leaf) is called, by several threads at once, for every leaf with a lattice point nearer to a triangle than reach
// (voxels); its values are then min(distance, reach), all inactive. points: index space. Progress: "measuring distances".
// Deterministic but for the order of the leaves.
std::vector<FloatLeafPtr> leavesAround(const std::vector<openvdb::Vec3d>& points,
                                       const std::vector<Triangle>& triangles, double reach,
                                       const std::function<void(openvdb::FloatTree::LeafNodeType&)>& finish,
                                       const Progress& progress);

}  // namespace isowave
