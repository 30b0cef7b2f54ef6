// How far the points of a lattice are from a region.
#pragma once

#include <memory>
#include <vector>

#include "lod/regions/region_shape.h"
#include "volume/mesh_winding.h"

namespace isowave::lod {

// Signed, exact on both sides; world units.
double distanceTo(const RegionBox& box, const openvdb::Vec3d& p);

class RegionDistance {
  public:
    virtual ~RegionDistance() = default;

    // Distance of a lattice point from the region, 0 or negative inside; world units. Where it is more than `most` on either side,
    // any number that is so, too.
    virtual double at(const openvdb::Coord& point, double most) const = 0;

    // Lattice points outside this box are farther than `distance`.
    virtual openvdb::CoordBBox boxWithin(double distance) const = 0;
};

// Of a box or a mesh, widened by its `within`.
class ShapeDistance : public RegionDistance {
  public:
    static constexpr double kLargest = 8192;  // voxels of a mesh, along an axis

    // lattice: index -> world, of the level that the region keeps. Throws InputError for a mesh of more than kLargest voxels.
    ShapeDistance(RegionShape shape, openvdb::math::Transform::ConstPtr lattice, const Progress& progress);

    double at(const openvdb::Coord& point, double most) const override;
    openvdb::CoordBBox boxWithin(double distance) const override;

  private:
    RegionShape shape_;
    openvdb::math::Transform::ConstPtr lattice_;
    std::unique_ptr<const LatticeLines> lines_;  // of a mesh
};

}  // namespace isowave::lod
