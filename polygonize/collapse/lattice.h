// Cubes in space, and which way the triangles in one face.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "isowave/mesh.h"

namespace isowave::collapse {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---- directions

// Bit i of a triangle's or a cell's facing: its normals are within a right angle of direction i, to a margin beyond rounding.
using Facing = std::uint32_t;

// Of each pair of opposite ones among the 26 neighbours of a cell of a lattice one.
inline constexpr std::array<Vec3, 13> kDirections{{{1, 0, 0},
                                                   {0, 1, 0},
                                                   {0, 0, 1},
                                                   {0.7, 0.7, 0},
                                                   {0.7, -0.7, 0},
                                                   {0.7, 0, 0.7},
                                                   {0.7, 0, -0.7},
                                                   {0, 0.7, 0.7},
                                                   {0, 0.7, -0.7},
                                                   {0.58, 0.58, 0.58},
                                                   {0.58, 0.58, -0.58},
                                                   {0.58, -0.58, 0.58},
                                                   {0.58, -0.58, -0.58}}};

// longest: of the triangle's sides; its normal is wrong by 1e-15 of the square at most.
inline Facing facingOf(const Vec3& normal, double longest2) {
    const double margin = 0.02 * length(normal) + 1e-14 * longest2;
    Facing facing = 0;
    for (std::size_t i = 0; i < kDirections.size(); ++i) {
        const double along = dot(kDirections[i], normal);
        facing |= static_cast<Facing>(along > margin) << (2 * i);
        facing |= static_cast<Facing>(along < -margin) << (2 * i + 1);
    }
    return facing;
}

// ---- lattices

struct Box {
    Vec3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};

    void add(const Vec3& p) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    bool meets(const Box& o) const {
        return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y &&
               low.z <= o.high.z && o.low.z <= high.z;
    }
};

using Cell = std::array<int, 3>;

// Cubes of a size, numbered from 0 on each axis. Points beyond belong to the nearest cube. A cube's number grows with the
// coordinate, whatever rounding does; so a box overlaps just the cubes from that of its low corner to that of its high one.
struct Lattice {
    Vec3 origin;
    double side = 1, perSide = 1;  // 1 / side
    Cell count{1, 1, 1};

    Cell cellOf(const Vec3& p) const {
        Cell cell;
        for (int a = 0; a < 3; ++a)
            cell[a] = static_cast<int>(
                std::clamp((p[a] - origin[a]) * perSide, 0.0, static_cast<double>(count[a] - 1)));
        return cell;
    }
    std::size_t size() const {
        return static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]) *
               static_cast<std::size_t>(count[2]);
    }
    std::size_t indexOf(int x, int y, int z) const {
        return (static_cast<std::size_t>(x) * static_cast<std::size_t>(count[1]) +
                static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(count[2]) +
               static_cast<std::size_t>(z);
    }
    // each(index) for all cells between two corners; stops when it says false.
    template <class Each>
    void forCells(const Cell& low, const Cell& high, const Each& each) const {
        for (int x = low[0]; x <= high[0]; ++x)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int z = low[2]; z <= high[2]; ++z)
                    if (!each(indexOf(x, y, z))) return;
    }
};

// Cubes of this side over a box, from its low corner on; the side is doubled until they are at most so many.
inline Lattice latticeOver(const Box& box, double side, std::size_t atMost) {
    for (side = side > 0 ? side : 1;; side *= 2) {
        double count = 1;
        for (int a = 0; a < 3; ++a) count *= std::floor((box.high[a] - box.low[a]) / side) + 1;
        if (count > static_cast<double>(atMost)) continue;
        Lattice lattice{box.low, side, 1 / side, {}};
        for (int a = 0; a < 3; ++a)
            lattice.count[a] = static_cast<int>(std::floor((box.high[a] - box.low[a]) / side)) + 1;
        return lattice;
    }
}

}  // namespace isowave::collapse
