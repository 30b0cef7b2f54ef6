// The logistic function and its inverse, in integers.
//
//   squash(x) = 65536 / (1 + exp(-x / 256))        stretch(p) = 256 ln(p / (1 - p))
//
// The tables are made by multiplications and divisions of doubles, which IEEE 754 rounds in one way only, so that they are the
// same on every machine; exp() and log() of a C library are not.
#pragma once

#include <array>
#include <cstdint>

#include "compress/coder/range_coder.h"

namespace isowave::compress {

inline constexpr int kStretchLimit = 2304;  // 9 in units of 1/256: p = 1.2e-4 and 1 - 1.2e-4

class Logistic {
  public:
    static const Logistic& tables();

    Probability squash(int x) const {
        x = x < -kStretchLimit ? -kStretchLimit : x > kStretchLimit ? kStretchLimit : x;
        return squash_[static_cast<std::size_t>(x + kStretchLimit)];
    }
    // p: probability in 1/4096, 0 <= p < 4096, taken at the middle of its bin. A model that has seen n < 4 bits counts for
    // less: (n + 1/2) / 4.
    int stretch(std::uint32_t p, std::uint32_t n) const { return stretch_[n < 4 ? n : 4][p]; }

  private:
    Logistic();
    std::array<std::uint16_t, 2 * kStretchLimit + 1> squash_{};
    std::array<std::array<std::int16_t, 4096>, 5> stretch_{};
};

}  // namespace isowave::compress
