// A hash of bytes that finds damage. Not cryptographic: not for malice.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace isowave {

// Two 64-bit lanes, each h <- mix((h ^ word) * p) with p odd. For a fixed word that is a bijection of h, and
// for a fixed h one of the word; so any change within one aligned 8-byte word changes both lanes for certain,
// and other changes escape with probability 2^-122.
class ContentHash {
  public:
    void add(const char* bytes, std::size_t count) {  // REQUIRES: all calls but the last: count % 8 == 0
        for (; count >= 8; bytes += 8, count -= 8) {
            std::uint64_t word;
            std::memcpy(&word, bytes, 8);
            step(word);
        }
        if (count > 0) {
            std::uint64_t word = 0;
            std::memcpy(&word, bytes, count);
            step(word);
            step(count);
        }
    }
    // As a UUID of version 8: xxxxxxxx-xxxx-8xxx-yxxx-xxxxxxxxxxxx, y in 8..b.
    std::string uuid() const {
        const std::uint64_t a = (lane_[0] & ~0xF000ULL) | 0x8000ULL;
        const std::uint64_t b = (lane_[1] & ~(3ULL << 62)) | (2ULL << 62);
        return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:012x}", a >> 32, (a >> 16) & 0xFFFF, a & 0xFFFF,
                           b >> 48, b & 0xFFFFFFFFFFFFULL);
    }
    static constexpr std::size_t kHexLength = 32;
    std::string hex() const { return fmt::format("{:016x}{:016x}", lane_[0], lane_[1]); }

  private:
    void step(std::uint64_t word) {
        for (int i = 0; i < 2; ++i) {
            lane_[i] = (lane_[i] ^ word) * kPrime[i];
            lane_[i] ^= lane_[i] >> 29;
        }
    }
    // The odd multipliers of xxHash64 (its PRIME64_1 and _2): any odd number keeps the claim above.
    static constexpr std::uint64_t kPrime[2] = {0x9E3779B185EBCA87ULL, 0xC2B2AE3D27D4EB4FULL};
    std::uint64_t lane_[2] = {1, 2};
};

}  // namespace isowave
