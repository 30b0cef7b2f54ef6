// The regions of a ladder that were asked for (LevelOptions::fine), on the lattices of the levels that they keep.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "lod/regions/kept_levels.h"

namespace isowave::lod {

// The steps of the levels that regions keep, ascending.
std::vector<int> stepsOf(const std::vector<FineRegion>& regions, const StepOrder& order);

class FineRegions {
  public:
    // Reads meshes. Throws InputError as regionShapeOf() does.
    FineRegions(const std::vector<FineRegion>& regions, const StepOrder& order, const Progress& progress);

    // Throws InputError for a region that lies beside the solid altogether. solid: the box around level 0.
    void requireWithin(const PointBox& solid) const;

    // To be called for every level, with its lattice. Whether a region keeps it.
    bool place(int step, const openvdb::math::Transform& lattice, const Progress& progress);

    // Those finer than a step on the lattice `own`, faded out over one voxel of it. REQUIRES: they have been placed.
    RegionsByStep regionsFor(int step, const openvdb::math::Transform& own) const;

  private:
    struct Placed {
        openvdb::math::Transform::ConstPtr lattice;
        std::vector<std::shared_ptr<const RegionDistance>> regions;
    };
    std::vector<RegionShape> shapes_;
    StepOrder order_;
    std::map<int, Placed> placed_;  // by step
};

}  // namespace isowave::lod
