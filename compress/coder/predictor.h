// A control point guessed from 16 earlier neighbours: the 13 that touch it and the three at distance 2 along the axes.
//
// One set of weights for each way in which the neighbours at x - 1, y - 1 and z - 1 are known. They are fitted by least squares
// to the file's own values, rounded to integers, and stored; prediction is integer arithmetic.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "compress/coder/window.h"

namespace isowave::compress {

inline constexpr std::array<Back, 16> kBefore{{{-2, 0, 0},
                                               {-1, -1, -1},
                                               {-1, -1, 0},
                                               {-1, -1, 1},
                                               {-1, 0, -1},
                                               {-1, 0, 0},
                                               {-1, 0, 1},
                                               {-1, 1, -1},
                                               {-1, 1, 0},
                                               {-1, 1, 1},
                                               {0, -2, 0},
                                               {0, -1, -1},
                                               {0, -1, 0},
                                               {0, -1, 1},
                                               {0, 0, -2},
                                               {0, 0, -1}}};
inline constexpr Back kX{-1, 0, 0}, kY{0, -1, 0}, kZ{0, 0, -1};
inline constexpr int kKinds = 8;  // x - 1 known + 2 (y - 1 known) + 4 (z - 1 known)

using Neighbours = std::array<std::int32_t, kBefore.size()>;  // their values
struct Weights {
    static constexpr int kBits = 13;  // a weight of 1 is 2^13
    std::array<std::array<std::int16_t, kBefore.size()>, kKinds> of{};
    std::int32_t guess(int kind, const Neighbours& neighbours) const {
        std::int64_t sum = 0;
        for (std::size_t i = 0; i < kBefore.size(); ++i)
            sum += std::int64_t{of[static_cast<std::size_t>(kind)][i]} * neighbours[i];
        return static_cast<std::int32_t>(std::clamp<std::int64_t>(sum >> kBits, -(1 << 30), 1 << 30));
    }
};

// values: of the lattice's points; outside: what stands for an unknown point outside, and its negative inside. importance: of
// the error of a value; the sum of importance^2 error^2 becomes least.
Weights fitWeights(const Lattice& lattice, const std::vector<std::int32_t>& values, std::int32_t outside,
                   const std::vector<float>& importance);

}  // namespace isowave::compress
