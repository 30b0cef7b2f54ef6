// A bit whose probability several models estimate, mixed in the logistic domain.
//
//   p = squash(sum_i w_i s_i),  s_i = confidence(n_i) stretch(p_i)
//
// and after the bit y: w_i += rate (y - p) s_i, the gradient of the code length, and p_i += (y - p_i) / (n_i + 1.5).
// Mattern, "Linear and geometric mixtures - analysis", DCC 2013; the arithmetic is that of M. Mahoney's lpaq.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "compress/coder/logistic.h"
#include "compress/coder/range_coder.h"

namespace isowave::compress {

// What one model knows about one bit in one context: the probability of a 1, and from how many bits.
class Counter {
  public:
    std::uint32_t probability() const { return state_ >> 20; }  // in 1/4096
    std::uint32_t count() const { return state_ & 255; }
    void update(bool bit);

  private:
    std::uint32_t state_ = std::uint32_t{1} << 31;  // 24 bits of probability, 8 of count
};

inline constexpr int kMostModels = 12;

class Mixer {
  public:
    // sets: of weights; each bit names the one that it uses.
    Mixer(int models, std::size_t sets);

    // REQUIRES: slots has `models` counters, set < sets.
    bool code(RangeCoder& coder, Counter* const* slots, std::size_t set, bool bit);

  private:
    int models_;
    std::vector<std::int32_t> weights_;  // in 2^-22, of a set side by side
};

// A bit of one model alone.
bool codeAlone(RangeCoder& coder, Counter& counter, bool bit);

}  // namespace isowave::compress
