// The lattice points that a fit to a mask works on: the band around the surface, in dense leaves that know their
// neighbours, so that a pass over all of it looks nothing up.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "volume/leaf_words.h"
#include "volume/padded_leaf.h"

namespace isowave::fitting {

using LeafValues = std::array<float, 512>;  // in a leaf's order

// The band: lattice points at most 4.5 voxels from the nearest lattice point of the other side. Squares of distances
// between lattice points are whole: at most 20.
inline constexpr int kBandReach = 4;  // offsets along an axis
inline constexpr int kBandSquared = 20;
// What `distance` has beside the band.
inline constexpr float kBeyondBand = 5;

struct MaskBand {
    static constexpr std::int32_t kOutside = -1, kInside = -2;

    std::vector<openvdb::Coord> origins;  // of the leaves that have a point of the band, ascending
    std::vector<std::array<std::int32_t, 27>>
        beside;  // leaf (b + 1 on each axis), or all of it kOutside, kInside
    // In voxels, to the nearest lattice point of the other side; negative inside. ±kBeyondBand beside the band.
    std::vector<LeafValues> distance;

    std::size_t leafCount() const { return origins.size(); }
};

// inside: value = inside, at every lattice point; active = stabbed nodes, as a NodeCollection has them. The band
// follows from the stabbed nodes alone.
MaskBand bandAround(const openvdb::BoolTree& inside);

// values: one entry a leaf of the band. inside, outside: what leaves without a point of the band are worth, 512 of it.
template <int Margin>
void gather(const MaskBand& band, const std::vector<LeafValues>& values, std::size_t leaf,
            const LeafValues& inside, const LeafValues& outside, PaddedLeaf<float, Margin, Margin>& block) {
    const auto source = [&](int bx, int by, int bz) {
        const std::int32_t at = band.beside[leaf][static_cast<std::size_t>(9 * bx + 3 * by + bz)];
        if (at >= 0) return values[static_cast<std::size_t>(at)].data();
        return (at == MaskBand::kInside ? inside : outside).data();
    };
    for (int bx = 0; bx < 3; ++bx)
        for (int by = 0; by < 3; ++by) {
            const float *below = source(bx, by, 0), *here = source(bx, by, 1), *above = source(bx, by, 2);
            const auto low = [](int b) { return std::max(-Margin, 8 * (b - 1)); };
            const auto end = [](int b) { return std::min(8 + Margin, 8 * b); };
            for (int x = low(bx); x < end(bx); ++x)
                for (int y = low(by); y < end(by); ++y) {
                    float* row = &block.values[block.index(x, y, -Margin)];
                    const int from = (x & 7) << 6 | (y & 7) << 3;
                    std::memcpy(row, below + from + 8 - Margin, Margin * sizeof(float));
                    std::memcpy(row + Margin, here + from, 8 * sizeof(float));
                    std::memcpy(row + Margin + 8, above + from, Margin * sizeof(float));
                }
        }
}

inline LeafValues allOf(float value) {
    LeafValues values;
    values.fill(value);
    return values;
}

}  // namespace isowave::fitting
