// A bit whose probability several models estimate, mixed in the logistic domain.
//
//   p = squash(sum_i w_i s_i),  s_i = confidence(n_i) stretch(p_i)
//
// and after the bit y: w_i += rate (y - p) s_i, the gradient of the code length, and p_i += (y - p_i) / (n_i + 1.5).
// Mattern, "Linear and geometric mixtures - analysis", DCC 2013; the arithmetic is that of M. Mahoney's lpaq.
// Everything is inline: these few lines run ten times for a control point.
#pragma once

#include <algorithm>
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
    void update(bool bit) {
        const std::uint32_t n = count();
        const auto p = static_cast<std::int64_t>(state_ >> 8);
        const std::int64_t target = bit ? 0xFFFFFF : 0;
        const std::int64_t moved = p + (((target - p) * static_cast<std::int64_t>(kRates[n])) >> 16);
        state_ = (static_cast<std::uint32_t>(moved) << 8) | (n < kMostCount ? n + 1 : n);
    }

  private:
    static constexpr std::uint32_t kMostCount = 250;  // beyond it a counter forgets
    // 2^16 / (n + 1.5)
    static constexpr std::array<std::uint32_t, 256> kRates = [] {
        std::array<std::uint32_t, 256> rates{};
        for (std::uint32_t n = 0; n < 256; ++n) rates[n] = 131072 / (2 * n + 3);
        return rates;
    }();
    std::uint32_t state_ = std::uint32_t{1} << 31;  // 24 bits of probability, 8 of count
};

inline Probability clamped(Probability p) {
    constexpr Probability kLeast = 6, kMost = 65536 - kLeast;
    return std::clamp(p, kLeast, kMost);
}

template <int Models>
class Mixer {
  public:
    using Slots = std::array<Counter*, Models>;

    // sets: of weights; each bit names the one that it uses.
    explicit Mixer(std::size_t sets) : weights_(sets, allOf(kFirstWeight)) {}

    // REQUIRES: set < sets.
    bool code(RangeCoder& coder, const Slots& slots, std::size_t set, bool bit) {
        Weights& w = weights_[set];
        std::array<std::int32_t, Models> s;
        std::int64_t sum = 0;
        for (std::size_t i = 0; i < Models; ++i) {
            s[i] = tables_.stretch(slots[i]->probability(), slots[i]->count());
            sum += static_cast<std::int64_t>(w[i]) * s[i];
        }
        const auto x =
            static_cast<int>(std::clamp<std::int64_t>(sum >> kWeightBits, -kStretchLimit, kStretchLimit));
        const Probability p = clamped(tables_.squash(x));
        bit = coder.code(bit, p);
        const std::int32_t error = (bit ? 65536 : 0) - static_cast<std::int32_t>(p);
        for (std::size_t i = 0; i < Models; ++i) {
            // 0.02 (y - p) s in the units of w, p and s: 0.02 2^22 / (2^16 2^8) = 1 / 200
            w[i] = std::clamp(w[i] + error * s[i] / 200, -kWeightLimit, kWeightLimit);
            slots[i]->update(bit);
        }
        return bit;
    }

  private:
    using Weights = std::array<std::int32_t, Models>;
    // In 2^-22: fine enough that the small errors of bits that are nearly certain still move a weight.
    static constexpr int kWeightBits = 22;
    static constexpr std::int32_t kWeightLimit = 1 << 29, kFirstWeight = 6710886 / Models;  // 1.6 together
    static Weights allOf(std::int32_t value) {
        Weights w;
        w.fill(value);
        return w;
    }
    const Logistic& tables_ = Logistic::tables();
    std::vector<Weights> weights_;  // of a set side by side
};

// A bit of one model alone.
inline bool codeAlone(RangeCoder& coder, Counter& counter, bool bit) {
    bit = coder.code(bit, clamped(16 * counter.probability() + 8));
    counter.update(bit);
    return bit;
}

}  // namespace isowave::compress
