// The grid that tiles lie in, and the lattice that their vertices lie on.
//
// Level l has cubes of side chunk 2^l, counted from one corner, so that a tile covers eight of the level before. All vertices of a level are
// points of one lattice, `units` steps a tile; a vertex on a border has the same lattice point from both sides, whatever
// number format a tile is written in.
#pragma once

#include <array>
#include <cstdint>

#include "base/point_box.h"
#include "isowave/mesh.h"

namespace isowave {

using LatticePoint = std::array<std::int64_t, 3>;
using TileIndex = std::array<std::int32_t, 3>;

// Floor of a / b. REQUIRES: b > 0.
constexpr std::int64_t floorDivided(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }

struct TileGrid {
    Point corner{};    // world units; a multiple of chunk
    double chunk = 1;  // side of a tile of level 0; a power of two, so that corners of tiles are exact

    double side(int level) const;
    Point cornerOf(int level, const TileIndex& tile) const;
    // The nearest point of a level's lattice, counted from corner.
    LatticePoint latticePointOf(const Point& p, int level, std::int64_t units) const;
};

// Voxels along a tile of level 0, at most; at least half of it.
inline constexpr double kVoxelsOfTile = 64;

// For a mesh whose finest level has this box. Coarser levels bulge: a quarter of a tile at the low side is left for them.
// Throws InputError for a voxel that is no length, or more than 2^31 of them along the box.
TileGrid gridAround(const PointBox& box, double voxel);

// The planes of one axis that no triangle crosses. In lattice points, numbered upwards, 0 at 0: the borders of tiles, and with
// `halves` also their middles, (units + 1) / 2 steps in where units is odd.
struct TilePlanes {
    std::int64_t units = 1;  // of a tile
    bool halves = false;

    std::int64_t at(std::int64_t number) const;
    std::int64_t lastAtOrBelow(std::int64_t x) const;
    bool isOn(std::int64_t x) const { return at(lastAtOrBelow(x)) == x; }
    // The tile that begins at this plane, or has it in the middle.
    std::int32_t tileOf(std::int64_t number) const {
        return static_cast<std::int32_t>(halves ? floorDivided(number, 2) : number);
    }
};

}  // namespace isowave
