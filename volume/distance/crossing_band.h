// The band of distances around a solid whose signs are known, from samples of a function that crosses zero there
// (volume/distance/crossings.h), leaf by leaf in parallel.
//
//   leaves    those that a node with a sign change is within reach of
//   measure   each from the samples around it
//   hang      into a tree; everything else becomes tiles by sign
#pragma once

#include <memory>
#include <vector>

#include "volume/distance/crossings.h"
#include "volume/distance/leaves.h"
#include "volume/field.h"
#include "volume/vdb.h"

namespace isowave {

// Origins of the leaves with a lattice point nearer than `reach` voxels, in the maximum norm, to the box around the nodes of
// some leaf of `nodes`; ascending by z, then y, then x.
std::vector<openvdb::Coord> leavesWithin(const NodeCollection& nodes, int reach);

// What one thread makes leaves with.
class LeafMaker {
  public:
    // halfWidth: in voxels.
    explicit LeafMaker(double halfWidth);

    // To be filled: samples() of the leaf at the origin that make() gets. lastFirst: x varies fastest in them, as in
    // images, and not z, as in leaves.
    LeafSamples& samples() { return samples_; }

    // A leaf of distances as volume/distance.h has them, up to CrossingDistances::kReach; null where nothing is so near.
    FloatLeafPtr make(const openvdb::Coord& origin, bool xFastest);

  private:
    float halfWidth_;
    CrossingDistances distances_;
    LeafSamples samples_;
};

// The grid of these leaves, some of which may be null, and of tiles by the sign that `signs` has there, with distances up to
// halfWidth: what is farther than CrossingDistances::kReach is carried on from there by openvdb::tools::dilateSdf (fast
// sweeping, first order).
openvdb::FloatGrid::Ptr bandGrid(std::vector<FloatLeafPtr> leaves, const NodeCollection& signs,
                                 double halfWidth);

}  // namespace isowave
