// A region made of cells: voxels of one level, of whose finer neighbour the details are kept there.
//
//   j     a cell, the voxel [j, j + 1) of the coarser lattice on each axis
//   h     how often each axis is halved from the finer lattice to the coarser: 0 or 1 between two levels
//
// On the finer lattice the cell is [2^h j, 2^h (j + 1)). F at a point in it depends on the control points from 2^h j - 1 to
// 2^h (j + 1) + 1: distances are to those, so that F in the cells is the finer level's where the weight is 1 at distance 0.
#pragma once

#include <openvdb/tree/Tree.h>

#include <vector>

#include "base/halving_tree.h"
#include "lod/regions/region_distance.h"

namespace isowave::lod {

// Active: the cell is in the set.
using Cells = openvdb::MaskTree;

// The cell that a point of the world lies in.
openvdb::Coord cellAt(const openvdb::math::Transform& lattice, const Point& world);

// The cells of a lattice halved so often that hold those of the other one.
Cells parentsOf(const Cells& cells, const std::array<int, 3>& halvings);

// Lengths are those of the lattice's steps, as if axes were at right angles, which those of images and meshes are.
class CellDistance : public RegionDistance {
  public:
    // REQUIRES: at least one cell, no active tiles.
    CellDistance(const Cells& cells, const std::array<int, 3>& halvings,
                 const openvdb::math::Transform& lattice);

    // Exact, 0 inside.
    double at(const openvdb::Coord& point, double most) const override;
    openvdb::CoordBBox boxWithin(double distance) const override;

  private:
    static constexpr std::size_t kInLeaf = 4;
    using Range = HalvingTree::Range;
    void divide(const Range& range);
    void bound(const Range& range);
    double squaredTo(const openvdb::CoordBBox& box, const openvdb::Coord& point) const;

    std::vector<openvdb::CoordBBox> cells_;  // runs of cells along z, on the finer lattice
    std::vector<openvdb::CoordBBox> boxes_;
    openvdb::Vec3d step_;  // of the finer lattice, world units
    HalvingTree tree_;
};

}  // namespace isowave::lod
