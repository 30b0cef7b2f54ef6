// A leaf's 8^3 values with a margin of neighbours around them, as one dense block: stencils then run without
// lookups.
#pragma once

#include <algorithm>
#include <array>

#include "volume/vdb.h"

namespace isowave {

// Low, High: voxels of margin below and above on each axis. z is fastest, as in a leaf.
template <class Value, int Low, int High>
struct PaddedLeaf {
    static constexpr int kSize = 8 + Low + High;
    std::array<Value, kSize * kSize * kSize> values;

    // x, y, z relative to the leaf's origin: -Low .. 7 + High.
    static constexpr int index(int x, int y, int z) {
        return ((x + Low) * kSize + (y + Low)) * kSize + (z + Low);
    }
    Value at(int x, int y, int z) const { return values[index(x, y, z)]; }

    // Copies from the leaves and tiles around `origin` (of a leaf). open(leaf) returns what reads that leaf's
    // rows: called with (offset, count, out) it copies the values at offset .. offset + count - 1. The
    // accessor gives the value of a place without leaf, which is the same all over it.
    template <class Accessor, class Open>
    void gatherRows(const Accessor& accessor, const openvdb::Coord& origin, const Open& open) {
        using Leaf = typename Accessor::TreeType::LeafNodeType;
        constexpr int kFrom = Low > 0 ? -1 : 0, kTo = High > 0 ? 1 : 0;
        const auto low = [](int b) { return std::max(-Low, 8 * b); };
        const auto high = [](int b) { return std::min(7 + High, 8 * b + 7); };
        for (int bx = kFrom; bx <= kTo; ++bx)
            for (int by = kFrom; by <= kTo; ++by)
                for (int bz = kFrom; bz <= kTo; ++bz) {
                    const openvdb::Coord at = origin.offsetBy(8 * bx, 8 * by, 8 * bz);
                    const int z = low(bz), count = high(bz) - z + 1;
                    const auto eachRow = [&](const auto& fill) {
                        for (int x = low(bx); x <= high(bx); ++x)
                            for (int y = low(by); y <= high(by); ++y)
                                fill(static_cast<openvdb::Index>(((x & 7) << 6) | ((y & 7) << 3) | (z & 7)),
                                     &values[index(x, y, z)]);
                    };
                    if (const Leaf* leaf = accessor.template probeConstNode<Leaf>(at)) {
                        const auto rows = open(*leaf);
                        eachRow([&](openvdb::Index offset, Value* out) { rows(offset, count, out); });
                    } else {
                        const auto uniform = static_cast<Value>(accessor.getValue(at));
                        eachRow([&](openvdb::Index, Value* out) { std::fill_n(out, count, uniform); });
                    }
                }
    }
    // read(leaf, offset) gives one of a leaf's values.
    template <class Accessor, class Read>
    void gather(const Accessor& accessor, const openvdb::Coord& origin, const Read& read) {
        gatherRows(accessor, origin, [&read](const auto& leaf) {
            return [&read, &leaf](openvdb::Index offset, int count, Value* out) {
                for (int i = 0; i < count; ++i) out[i] = read(leaf, offset + static_cast<openvdb::Index>(i));
            };
        });
    }
    // The leaves' own values, by rows of their buffers: asking for them one by one costs four times as much.
    // REQUIRES: leaves of numbers (a leaf of bool has no buffer of bool).
    template <class Accessor>
    void gather(const Accessor& accessor, const openvdb::Coord& origin) {
        gatherRows(accessor, origin, [](const auto& leaf) {
            return [data = leaf.buffer().data()](openvdb::Index offset, int count, Value* out) {
                const auto* row = data + offset;
                if (count == 8)
                    for (int i = 0; i < 8; ++i) out[i] = static_cast<Value>(row[i]);
                else
                    for (int i = 0; i < count; ++i) out[i] = static_cast<Value>(row[i]);
            };
        });
    }
};

// Applies the symmetric three-tap filter (side, centre, side) on each axis to the inner 8^3 voxels of a block
// with a margin of one. out: 512 values in a leaf's order.
inline void filterThreeTaps(const PaddedLeaf<double, 1, 1>& block, double centre, double side,
                            std::array<double, 512>& out) {
    constexpr int kSize = PaddedLeaf<double, 1, 1>::kSize;
    std::array<double, kSize * kSize * 8> alongZ;
    for (int xy = 0; xy < kSize * kSize; ++xy)
        for (int z = 0; z < 8; ++z) {
            const double* p = &block.values[xy * kSize + z];
            alongZ[xy * 8 + z] = side * (p[0] + p[2]) + centre * p[1];
        }
    std::array<double, kSize * 64> alongY;
    for (int x = 0; x < kSize; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z) {
                const double* p = &alongZ[(x * kSize + y) * 8 + z];
                alongY[x * 64 + y * 8 + z] = side * (p[0] + p[16]) + centre * p[8];
            }
    for (int x = 0; x < 8; ++x)
        for (int yz = 0; yz < 64; ++yz) {
            const double* p = &alongY[x * 64 + yz];
            out[x * 64 + yz] = side * (p[0] + p[128]) + centre * p[64];
        }
}

}  // namespace isowave
