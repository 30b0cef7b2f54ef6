// Small things that the coders of values share.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>

namespace isowave::compress {

inline constexpr int kContextBits = 16;  // contexts of a model, hashed

// A context of several small numbers.
inline std::uint32_t hashed(std::initializer_list<std::int32_t> parts) {
    std::uint64_t h = 0;
    for (const std::int32_t part : parts) {
        h = (h + static_cast<std::uint32_t>(part) + 1) * 0x9E3779B97F4A7C15ULL;
        h ^= h >> 29;
    }
    return static_cast<std::uint32_t>(h >> 8) & ((1u << kContextBits) - 1);
}

// Of the contexts that a chunk of so many points can fill: small chunks make small tables, which are quick to clear.
inline int contextBitsFor(std::size_t points) {
    return std::clamp(static_cast<int>(std::bit_width(points)) - 3, 10, kContextBits);
}
inline int placeBitsFor(std::size_t points) {
    return std::clamp(static_cast<int>(std::bit_width(points)), 12, 20);
}

// floor(2 log2(n)), n > 0
inline int twiceLog(std::uint64_t n) {
    const int f = static_cast<int>(std::bit_width(n)) - 1;
    const std::uint64_t top = f > 15 ? n >> (f - 15) : n << (15 - f);  // 1 .. 2 as 2^15 .. 2^16
    return 2 * f + (top * top >= (std::uint64_t{1} << 31));
}

// The mean of errors at earlier neighbours, weighted by 1 / (|x| + |y| + |z|)^2: 36, 9, 4 and their sum.
inline constexpr std::array<std::uint64_t, 16> kErrorWeights{9, 4, 9, 4, 9,  36, 9, 4,
                                                             9, 4, 9, 9, 36, 9,  9, 36};
inline constexpr std::uint64_t kErrorWeightSum = 205;

}  // namespace isowave::compress
