// The solid of the benchmarks: a ball perforated by a gyroid, turned so that nothing lies along the lattice (on a
// grid-aligned analytic field whole runs of numbers repeat, and everything looks faster than it is).
#pragma once

#include "volume/vdb.h"

namespace isowave::bench {

// At any size the same solid: the lattice [0, voxels)^3 is laid over one and the same part.
class PerforatedPart {
  public:
    explicit PerforatedPart(int voxels);

    int voxels() const { return voxels_; }
    // Signed distance in voxels, negative inside; near the surface to a few percent (a gyroid's is not exact), and
    // never changing faster than kSlope voxels a voxel.
    double operator()(const openvdb::Vec3d& point) const;

    static constexpr double kSlope = 1.6;

  private:
    int voxels_;
    double unit_;  // voxels of this lattice for one of the 256^3 lattice
};

// The part as distanceFromFunction() would give it (clamped to +-halfWidth voxels, active where nearer, tiles of the
// right sign), but built from the surface outwards: blocks that the surface cannot reach, by kSlope, are never
// sampled, so that time and memory go with the surface and 1024^3 needs no dense grid.
openvdb::FloatGrid::Ptr sparseDistance(const PerforatedPart& part, double halfWidth);

}  // namespace isowave::bench
