// Binary range coder: bits with probabilities to bytes, and back.
//
// The interval [low, high] of 32-bit numbers is split at every bit in proportion to the probability of a 1; leading bytes that
// both ends share are written. A bit of probability p costs log2(1/p) bits and about 0.0001 more. Martin, "Range encoding: an
// algorithm for removing redundancy from a digitised message", 1979, in the carryless form of M. Mahoney's lpaq.
// Bits of probability 1/2 go past it, into a stream of their own. Integers only: the bytes are the same on every machine.
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
    RangeCoder() = default;  // encodes
    // Decodes; the bytes must outlive it. Past their end it reads zeros. Throws std::runtime_error for bytes that are none of
    // finish().
    explicit RangeCoder(std::string_view encoded);

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
    std::uint32_t raw(std::uint32_t value, int count) {
        return decodes_ ? takeRaw(count) : putRaw(value, count);
    }

    // What was encoded. REQUIRES: !decodes(); nothing is coded afterwards.
    std::string finish();
    // Whether the decoder has taken exactly the bytes that finish() gave: one that has not was fed other bytes, or read with
    // another model.
    bool atEnd() const { return at_ == encoded_.size() && rawAt_ == raw_.size() && reservoir_ == 0; }

  private:
    void shift() {
        if (decodes_)
            window_ = (window_ << 8) | next();
        else
            bytes_ += static_cast<char>(high_ >> 24);
        low_ <<= 8;
        high_ = (high_ << 8) | 255;
    }
    std::uint8_t next() {
        return at_ < encoded_.size() ? static_cast<std::uint8_t>(encoded_[at_++]) : std::uint8_t{0};
    }
    static std::uint64_t lowest(std::uint64_t value, int count) {
        return value & ((std::uint64_t{1} << count) - 1);
    }
    std::uint32_t putRaw(std::uint32_t value, int count) {
        reservoir_ |= lowest(value, count) << held_;
        for (held_ += count; held_ >= 8; held_ -= 8, reservoir_ >>= 8)
            rawBytes_ += static_cast<char>(reservoir_);
        return static_cast<std::uint32_t>(lowest(value, count));
    }
    std::uint32_t takeRaw(int count) {
        for (; held_ < count; held_ += 8)
            reservoir_ |=
                (rawAt_ < raw_.size() ? std::uint64_t{static_cast<std::uint8_t>(raw_[rawAt_++])} : 0)
                << held_;
        const std::uint64_t value = lowest(reservoir_, count);
        reservoir_ >>= count;
        held_ -= count;
        return static_cast<std::uint32_t>(value);
    }

    std::uint32_t low_ = 0, high_ = 0xFFFFFFFF, window_ = 0;
    bool decodes_ = false;
    std::uint64_t reservoir_ = 0;  // raw bits, the next one lowest
    int held_ = 0;                 // of them
    std::string bytes_, rawBytes_;
    std::string_view encoded_, raw_;
    std::size_t at_ = 0, rawAt_ = 0;
};

}  // namespace isowave::compress
