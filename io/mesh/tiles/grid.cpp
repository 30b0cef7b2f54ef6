#include "io/mesh/tiles/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isowave/error.h"

namespace isowave {
namespace {

constexpr std::int64_t kMostVoxels = std::int64_t{1} << 31;  // as of images: tiles are counted with 32 bits

}  // namespace

double TileGrid::side(int level) const { return std::ldexp(chunk, level); }

Point TileGrid::cornerOf(int level, const TileIndex& tile) const {
    Point p = corner;
    for (std::size_t a = 0; a < 3; ++a) p[a] += tile[a] * side(level);
    return p;
}

LatticePoint TileGrid::latticePointOf(const Point& p, int level, std::int64_t units) const {
    LatticePoint q{};
    for (std::size_t a = 0; a < 3; ++a)
        q[a] = std::llround((p[a] - corner[a]) / side(level) * static_cast<double>(units));
    return q;
}

TileGrid gridAround(const PointBox& box, double voxel) {
    const double most =
        std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
    if (!(voxel > 0 && std::isfinite(voxel) && most / voxel <= static_cast<double>(kMostVoxels)))
        throw InputError(
            "tiles",
            fmt::format("a voxel of {:.6g} and a solid that is {:.6g} wide; expected {} voxels at most",
                        voxel, most, kMostVoxels));
    int exponent = 0;
    std::frexp(kVoxelsOfTile * voxel, &exponent);  // 2^(exponent - 1) <= that < 2^exponent
    TileGrid grid;
    grid.chunk = std::ldexp(1.0, exponent - 1);
    for (std::size_t a = 0; a < 3; ++a)
        grid.corner[a] = grid.chunk * std::floor(box.low[a] / grid.chunk - 0.25);
    return grid;
}

std::int64_t TilePlanes::at(std::int64_t number) const {
    if (!halves) return number * units;
    const std::int64_t tile = floorDivided(number, 2);
    return tile * units + (number - 2 * tile) * ((units + 1) / 2);
}

std::int64_t TilePlanes::lastAtOrBelow(std::int64_t x) const {
    const std::int64_t tile = floorDivided(x, units);
    if (!halves) return tile;
    return 2 * tile + (x - tile * units >= (units + 1) / 2 ? 1 : 0);
}

}  // namespace isowave
