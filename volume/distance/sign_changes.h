// How far the lattice points of a leaf are from the nearest lattice edge whose ends have different signs.
//
// The middle of such an edge lies at a whole place on two axes and at a half on its own. So four times the squared
// distance is (2e + 1)^2 + 4 j^2 + 4 k^2, a small integer, and its least value is found axis by axis as in
// volume/distance/crossings.h: along the rows by looking up their bits, along the two others for eight points at once.
#pragma once

#include <array>
#include <cstdint>

namespace isowave {

// Signs at -5 .. 12 around a leaf on each axis: bit k + 5 of [i + 5][j + 5].
struct LeafSigns {
    static constexpr int kBefore = 5, kSize = 8 + 2 * kBefore;
    std::array<std::array<std::uint32_t, kSize>, kSize> rows;
};

// Four times the squared distance to the nearest edge's middle, [64 i + 8 j + k]: exact up to kFourfoldReach, more than that
// beyond.
inline constexpr int kFourfoldReach =
    4 * LeafSigns::kBefore * LeafSigns::kBefore + 20;  // the next edge is at 5.5 = sqrt(121)/2
std::array<std::int16_t, 512> toSignChanges(const LeafSigns& signs);

}  // namespace isowave
