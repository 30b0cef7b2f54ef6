// What an edit adds or cuts, as a function on the lattice of level 0.
//
// The tool's signed distance is exact at the lattice points of level L. Quasi-interpolation makes a B-spline of it, as of any
// solid's (volume/fit.h), whose values at the lattice points of level 0 are the tool's function T. So a smooth surface is right to
// the fourth order of L's voxel, and edges are as round as level L can have them.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isowave/pyramid.h"
#include "lod/regions/region_shape.h"
#include "volume/field.h"

namespace isowave::lod {

// 512 values of a leaf of level 0, in its order: signed distances, voxels of level 0, negative inside.
using LeafValues = std::array<double, 512>;

// What can be united with a solid: where it may be, and its function there.
class Operand {
  public:
    enum class Side : char { outside, inside, mixed };
    virtual ~Operand() = default;

    // Origins of all leaves in which the function may be below its reach.
    virtual std::vector<openvdb::Coord> leaves(const Progress& progress) const = 0;
    // inside, outside: beyond the reach in the whole leaf, and nothing is put into `values`. May be called by several threads.
    virtual Side values(const openvdb::Coord& origin, LeafValues& values) const = 0;
};

// A ball, a box or a mesh.
class ToolFunction : public Operand {
  public:
    static constexpr double kLargest = 4096;  // voxels of level 0, along an axis

    // What the solid lets a tool take.
    struct Room {
        std::optional<PointBox> solid;  // of a cut: beyond the box around the solid nothing changes
        double bytes = HUGE_VAL;
    };

    // name: "--add ball:0,0,0,1", for messages. lattice: of level 0. halvings: of its axes, up to level L. reach: voxels of level 0 on both sides in which T is wanted.
    // Throws UsageError for a tool that is none; InputError for a mesh that is open or cannot be read, and, before memory is taken, for
    // a tool beyond kLargest or one that takes more than room.bytes.
    ToolFunction(const EditTool& tool, const std::string& name, const openvdb::math::Transform& lattice,
                 const std::array<int, 3>& halvings, double reach, const Room& room,
                 const Progress& progress);

    std::vector<openvdb::Coord> leaves(const Progress& progress) const override;
    Side values(const openvdb::Coord& origin, LeafValues& values) const override;

    double volume() const { return volume_; }  // world units^3
    double reach() const { return reach_; }

  private:
    double distance(const openvdb::Vec3d& world,
                    double most) const;  // without sign; any more than `most` beyond that
    Side sideOf(const openvdb::Coord& origin, int size) const;
    double bytesFor(const Room& room, double halfWidth) const;

    std::function<double(const openvdb::Vec3d&)> analytic_;  // signed; of a ball or a box
    std::optional<RegionShape::Closed> mesh_;
    openvdb::math::Transform::ConstPtr lattice_;
    PointBox bounds_;  // world
    double volume_ = 0, area_ = 0, reach_ = 0, margin_ = 0;
    std::array<int, 3> halvings_{};
    BSplineField sampled_;     // of level L, voxels of level 0
    openvdb::Coord shift_{0};  // lattice point 0 of level L in it
};

// "ball:0,0,0,1", "0,0,0:1,1,1", "part.stl", "a mesh": what messages call it.
std::string textOf(const EditTool& tool);

// Lattice of a level: whole multiples of 2^halvings.
openvdb::math::Transform::Ptr latticeOf(const openvdb::math::Transform& finest,
                                        const std::array<int, 3>& halvings);

// Edge of a cube that is as large as a voxel, world units.
double voxelOf(const openvdb::math::Transform& lattice);

}  // namespace isowave::lod
