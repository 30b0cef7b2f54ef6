// Binary range coder: bits with probabilities to bytes, and back.
//
// The interval [low, high] of 32-bit numbers is split at every bit in proportion to the probability of a 1; leading bytes that
// both ends share are written. A bit of probability p costs log2(1/p) bits and about 0.0001 more. Martin, "Range encoding: an
// algorithm for removing redundancy from a digitised message", 1979, in the carryless form of M. Mahoney's lpaq.
// Integers only: the bytes are the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace isowave::compress {

// A probability of a 1 in 1/65536.
using Probability = std::uint32_t;

// Encoder and decoder in one, so that a model is written once for both ways: code() takes the bit when it encodes, and
// ignores its argument when it decodes; it returns the bit in both cases.
class RangeCoder {
  public:
    RangeCoder() = default;                         // encodes
    explicit RangeCoder(std::string_view encoded);  // decodes; the bytes must outlive it. Past their end it reads zeros.

    bool decodes() const { return decodes_; }
    // REQUIRES: 1 <= one <= 65535.
    bool code(bool bit, Probability one) {
        const std::uint32_t middle =
            low_ + static_cast<std::uint32_t>((static_cast<std::uint64_t>(high_ - low_) * one) >> 16);
        if (decodes_) bit = window_ <= middle;
        (bit ? high_ : low_) = bit ? middle : middle + 1;
        while (((low_ ^ high_) >> 24) == 0) shift();
        return bit;
    }
    // The low `count` bits of `value`, each at probability 1/2. REQUIRES: 0 <= count <= 32.
    std::uint32_t raw(std::uint32_t value, int count);

    // What was encoded. REQUIRES: !decodes(); nothing is coded afterwards.
    std::string finish();
    // Whether the decoder has taken exactly the bytes that finish() gave: one that has not was fed other bytes, or read with
    // another model.
    bool atEnd() const { return at_ == encoded_.size(); }

  private:
    void shift();
    std::uint8_t next();

    std::uint32_t low_ = 0, high_ = 0xFFFFFFFF, window_ = 0;
    bool decodes_ = false;
    std::string bytes_;
    std::string_view encoded_;
    std::size_t at_ = 0;
};

}  // namespace isowave::compress
