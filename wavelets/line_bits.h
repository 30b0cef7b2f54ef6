// Lattice points of a leaf as bits, by lines along an axis: runs, parities and signs are operations on words.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "volume/leaf_words.h"

namespace isowave::wavelets {

inline constexpr int kLeafLog2 = 3, kLeafDim = 8, kLinesPerLeaf = kLeafDim * kLeafDim;

using Word = std::uint64_t;
// A leaf's bits (LeafWords) by lines: word i, byte j holds the eight positions of line 8i + j along an axis,
// lowest first; i and j are the coordinates on the two other axes in ascending order.
using LeafLines = std::array<Word, kLeafDim>;

// Bit 8i + j -> bit 8j + i (Warren: Hacker's Delight, 7-3).
constexpr Word transposed8x8(Word w) {
    Word t = (w ^ (w >> 7)) & 0x00AA00AA00AA00AAULL;
    w ^= t ^ (t << 7);
    t = (w ^ (w >> 14)) & 0x0000CCCC0000CCCCULL;
    w ^= t ^ (t << 14);
    t = (w ^ (w >> 28)) & 0x00000000F0F0F0F0ULL;
    return w ^ t ^ (t << 28);
}

// Byte j of words[i] -> byte i of words[j], by halves, quarters and bytes, for kMany words side by side.
template <std::size_t kMany>
constexpr void transposeBytes(std::array<std::array<Word, kMany>, 8>& words) {
    constexpr Word kMasks[] = {0x00000000FFFFFFFFULL, 0x0000FFFF0000FFFFULL, 0x00FF00FF00FF00FFULL};
    int stage = 0;
    for (std::size_t apart = 4; apart != 0; apart /= 2, ++stage)
        for (std::size_t i = 0; i < 8; ++i)
            if ((i & apart) == 0)
                for (std::size_t m = 0; m < kMany; ++m) {
                    Word &a = words[i][m], &b = words[i + apart][m];
                    const Word t = (a >> 8 * apart ^ b) & kMasks[stage];
                    b ^= t;
                    a ^= t << 8 * apart;
                }
}

// z: word x is bytes y already. y: each word transposed. x: byte y of the eight words, side by side and
// transposed, is the eight lines of that y.
constexpr LeafLines linesOf(const LeafWords& words, int axis) {
    if (axis == 2) return words;
    LeafLines lines{};
    if (axis == 0) {
        std::array<std::array<Word, 1>, 8> bytes{};
        for (int x = 0; x < kLeafDim; ++x) bytes[x][0] = words[x];
        transposeBytes(bytes);
        for (int y = 0; y < kLeafDim; ++y) lines[y] = bytes[y][0];
    } else {
        lines = words;
    }
    for (Word& w : lines) w = transposed8x8(w);
    return lines;
}
constexpr LeafWords wordsOfLines(const LeafLines& lines, int axis) {
    if (axis == 2) return lines;
    LeafWords words = lines;
    for (Word& w : words) w = transposed8x8(w);
    if (axis == 1) return words;
    std::array<std::array<Word, 1>, 8> bytes{};
    for (int y = 0; y < kLeafDim; ++y) bytes[y][0] = words[y];
    transposeBytes(bytes);
    for (int x = 0; x < kLeafDim; ++x) words[x] = bytes[x][0];
    return words;
}

// Bits 0, 2, 4, ... of a word, packed.
constexpr Word evenBits(Word w) {
    w &= 0x5555555555555555ULL;
    w = (w | w >> 1) & 0x3333333333333333ULL;
    w = (w | w >> 2) & 0x0F0F0F0F0F0F0F0FULL;
    w = (w | w >> 4) & 0x00FF00FF00FF00FFULL;
    w = (w | w >> 8) & 0x0000FFFF0000FFFFULL;
    return (w | w >> 16) & 0x00000000FFFFFFFFULL;
}

// The even positions along an axis of two leaves, one behind the other: those of a leaf half as long.
constexpr LeafWords evenPositions(const LeafWords& low, const LeafWords& high, int axis) {
    LeafWords even{};
    constexpr int kHalf = kLeafDim / 2;
    for (int x = 0; x < kLeafDim; ++x)
        if (axis == 0) {
            even[x] = x < kHalf ? low[2 * x] : high[2 * (x - kHalf)];
        } else if (axis == 1) {
            const auto evenBytes = [](Word w) {
                w &= 0x00FF00FF00FF00FFULL;
                w = (w | w >> 8) & 0x0000FFFF0000FFFFULL;
                return (w | w >> 16) & 0x00000000FFFFFFFFULL;
            };
            even[x] = evenBytes(low[x]) | evenBytes(high[x]) << 32;
        } else {
            const auto evenOfBytes = [](Word w) {
                w &= 0x5555555555555555ULL;
                w = (w | w >> 1) & 0x3333333333333333ULL;
                return (w | w >> 2) & 0x0F0F0F0F0F0F0F0FULL;
            };
            even[x] = evenOfBytes(low[x]) | evenOfBytes(high[x]) << 4;
        }
    return even;
}

}  // namespace isowave::wavelets
