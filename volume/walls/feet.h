// Where the surface of a mesh is nearest to lattice points, and which way it faces there.
#pragma once

#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/mesh_nearest.h"
#include "volume/vdb.h"

namespace isowave {

// The foot of a lattice point x, all in index space of the distances.
struct Foot {
    openvdb::Vec3f at;      // the surface's point nearest to x
    openvdb::Vec3f normal;  // outward, of length 1; 0: x has no foot
    float distance = 0;     // signed, of x, in voxels

    bool isThere() const { return normal != openvdb::Vec3f(0.0f); }
};

// Feet of the lattice points of a mask, one after the other, leaf by leaf.
class Feet {
  public:
    // points: index space of `distance`, which has the signed distances of the mesh (distanceFromMesh). The
    // normal is the nearest triangle's: from x - foot it would be lost where a face passes through lattice
    // points. Which of its two sides is outside follows from the sign of the distance wherever x is off the
    // triangle's plane, so an orientation that cannot be trusted does no harm.
    // No foot: the nearest triangle is degenerate or farther than `farthest`, or its distance is not the one
    // in the grid, as inside solids that overlap (distanceFromMesh lifts those).
    Feet(const openvdb::MaskTree& mask, const openvdb::FloatTree& distance,
         const TriangleHierarchy& triangles, double farthest, const Progress& progress = {});

    const openvdb::MaskTree& mask() const { return mask_; }
    const std::vector<Foot>& all() const { return feet_; }
    // Index of the first foot of a leaf of mask().
    std::uint32_t firstOf(const openvdb::MaskTree::LeafNodeType& leaf) const {
        return first_[leaf.transientData()];
    }

  private:
    openvdb::MaskTree mask_;
    std::vector<std::uint32_t> first_;
    std::vector<Foot> feet_;
};

}  // namespace isowave
