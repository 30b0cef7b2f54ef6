#include "volume/distance/sign_changes.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace isowave {
namespace {

constexpr int kSize = LeafSigns::kSize, kBefore = LeafSigns::kBefore, kEdges = kSize - 1;
constexpr std::int16_t kNone = 8192;

// Eight points of a row; every processor that this is built for has registers of that size.
typedef std::int16_t Row __attribute__((vector_size(16)));

void takeLeast(Row& least, const Row& other, int more) {
    const Row sum = other + static_cast<std::int16_t>(more);
    least = least < sum ? least : sum;
}

// By the bits at -5 .. 5 from a place: four times the least squared distance to one that is set; whole places, or (along the
// edges' own axis) halves.
template <bool kHalves>
constexpr auto nearestBit = [] {
    constexpr int kWindow = 2 * kBefore + 1;
    std::array<std::int16_t, 1 << kWindow> table{};
    for (unsigned bits = 0; bits < table.size(); ++bits) {
        int least = kNone;
        for (int n = 0; n < kWindow; ++n) {
            const int twice = 2 * (n - kBefore) + kHalves;
            if (bits >> n & 1) least = std::min(least, twice * twice);
        }
        table[bits] = static_cast<std::int16_t>(least);
    }
    return table;
}();

template <bool kHalves>
Row alongRow(std::uint32_t edges) {
    Row row;
    for (int k = 0; k < 8; ++k) row[k] = nearestBit<kHalves>[edges >> k & ((1u << (2 * kBefore + 1)) - 1)];
    return row;
}

// Rows of which few hold something.
struct Rows {
    std::uint32_t used[kSize] = {};  // bit j of [i]
    Row rows[kSize][kSize];
    void set(int i, int j, const Row& row) {
        used[i] |= 1u << j;
        rows[i][j] = row;
    }
    // The least for place j of the leaf in plane i. `count` places from -5 on are looked at.
    void takeLeastTo(Row& least, int i, int j, bool halves) const {
        for (std::uint32_t bits = used[i] >> j & ((1u << (2 * kBefore + 1)) - 1); bits; bits &= bits - 1) {
            const int n = std::countr_zero(bits), twice = 2 * (n - kBefore) + halves;
            takeLeast(least, rows[i][n + j], twice * twice);
        }
    }
};

constexpr std::uint32_t kAllEdges = (1u << kEdges) - 1;

}  // namespace

std::array<std::int16_t, 512> toSignChanges(const LeafSigns& signs) {
    Rows first, second, third;  // edges along the first, second, third axis
    for (int i = 0; i < kSize; ++i)
        for (int j = 0; j < kSize; ++j) {
            const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
            const std::uint32_t row = signs.rows[a][b];
            if (i < kEdges)
                if (const std::uint32_t edges = row ^ signs.rows[a + 1][b])
                    first.set(i, j, alongRow<false>(edges));
            if (j < kEdges)
                if (const std::uint32_t edges = row ^ signs.rows[a][b + 1])
                    second.set(i, j, alongRow<false>(edges));
            if (const std::uint32_t edges = (row ^ row >> 1) & kAllEdges)
                third.set(i, j, alongRow<true>(edges));
        }
    std::array<std::int16_t, 512> result;
    const Row none = Row{} + kNone;
    for (int j = 0; j < 8; ++j) {
        Row own[kSize], others[kSize];  // along the first axis: of edges along it, and of the others
        for (int i = 0; i < kSize; ++i) {
            own[i] = others[i] = none;
            first.takeLeastTo(own[i], i, j, false);
            second.takeLeastTo(others[i], i, j, true);
            third.takeLeastTo(others[i], i, j, false);
        }
        for (int i = 0; i < 8; ++i) {
            Row least = none;
            for (int n = -kBefore; n <= kBefore; ++n) {
                takeLeast(least, others[i + kBefore + n], 4 * n * n);
                takeLeast(least, own[i + kBefore + n], (2 * n + 1) * (2 * n + 1));
            }
            __builtin_memcpy(&result[static_cast<std::size_t>(64 * i + 8 * j)], &least, sizeof least);
        }
    }
    return result;
}

}  // namespace isowave
