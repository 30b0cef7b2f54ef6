// Which tiles there are at which level, as a tree: a tile's children are the eight of the level before that it covers.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "io/mesh/tiles/clip.h"

namespace isowave {

inline TileIndex parentOf(const TileIndex& tile) {
    TileIndex parent{};
    for (std::size_t a = 0; a < 3; ++a) parent[a] = static_cast<std::int32_t>(floorDivided(tile[a], 2));
    return parent;
}
// octant: bit x + 2 y + 4 z.
inline TileIndex childOf(const TileIndex& tile, int octant) {
    return {2 * tile[0] + (octant & 1), 2 * tile[1] + (octant >> 1 & 1), 2 * tile[2] + (octant >> 2 & 1)};
}

// The tiles of one level, in Z-order.
template <class Content>
using TileMap = std::map<TileIndex, Content, decltype(&zOrderLess)>;

// By how many tiles of level 0 the grid's corner has to go down for no index to be below 0: 0 or a power of two, so that the tree stays
// the same one. Indices of level l then rise by this over 2^l; it is a multiple of 2^l for all levels.
template <class Content>
std::int64_t shiftOf(const std::vector<TileMap<Content>>& levels) {
    std::int64_t lowest = 0, largest = 1;
    for (std::size_t l = 0; l < levels.size(); ++l)
        for (const auto& [at, content] : levels[l])
            for (const std::int64_t x : at) {
                lowest = std::min(lowest, x * (std::int64_t{1} << l));
                largest = std::max(largest, (x < 0 ? -x : x + 1) * (std::int64_t{1} << l));
            }
    if (lowest == 0) return 0;
    std::int64_t shift = std::int64_t{1} << levels.size();
    while (shift < largest) shift *= 2;
    return shift;
}

}  // namespace isowave
