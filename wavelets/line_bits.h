// Lines of lattice points as strings of bits: the 64 lines along an axis that a column of leaves holds, one bit a
// position. Runs, parities and signs are then operations on words, 64 positions at a time.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "volume/leaf_words.h"

namespace isowave::wavelets {

static_assert(std::endian::native == std::endian::little, "bytes of a word are addressed in ascending order");

inline constexpr int kLeafLog2 = 3, kLeafDim = 8, kLinesPerLeaf = kLeafDim * kLeafDim;

using Word = std::uint64_t;
// A leaf's bits (LeafWords) by lines: byte l holds the eight positions of line l along an axis, lowest first. Lines are numbered
// 8 i + j, i and j the coordinates on the two other axes in ascending order.
using LeafLines = std::array<std::uint8_t, kLinesPerLeaf>;

// Bit 8i + j -> bit 8j + i (Warren: Hacker's Delight, 7-3).
constexpr Word transposed8x8(Word w) {
    Word t = (w ^ (w >> 7)) & 0x00AA00AA00AA00AAULL;
    w ^= t ^ (t << 7);
    t = (w ^ (w >> 14)) & 0x0000CCCC0000CCCCULL;
    w ^= t ^ (t << 14);
    t = (w ^ (w >> 28)) & 0x00000000F0F0F0F0ULL;
    return w ^ t ^ (t << 28);
}

LeafLines linesOf(const LeafWords& words, int axis);
LeafWords wordsOfLines(const LeafLines& lines, int axis);

// Bits 0, 2, 4, ... of a word, packed.
constexpr std::uint32_t evenBits(Word w) {
    w &= 0x5555555555555555ULL;
    w = (w | w >> 1) & 0x3333333333333333ULL;
    w = (w | w >> 2) & 0x0F0F0F0F0F0F0F0FULL;
    w = (w | w >> 4) & 0x00FF00FF00FF00FFULL;
    w = (w | w >> 8) & 0x0000FFFF0000FFFFULL;
    return static_cast<std::uint32_t>(w | w >> 16);
}

// 64 lines of leaves 0 .. leafCount - 1, positions 0 .. 8 leafCount - 1.
class LineBits {
  public:
    // All bits 0. Keeps its memory.
    void reset(int leafCount) {
        wordCount_ = (leafCount + kLeafDim - 1) / kLeafDim;
        words_.assign(std::size_t(wordCount_) * kLinesPerLeaf, 0);
    }
    int wordCount() const { return wordCount_; }
    Word* line(int l) { return words_.data() + std::ptrdiff_t(l) * wordCount_; }
    const Word* line(int l) const { return words_.data() + std::ptrdiff_t(l) * wordCount_; }

    bool at(int l, int position) const { return line(l)[position >> 6] >> (position & 63) & 1; }
    // Sets first .. last.
    void set(int l, int first, int last) {
        Word* w = line(l);
        const Word from = ~Word{0} << (first & 63), to = ~Word{0} >> (63 - (last & 63));
        if (first >> 6 == last >> 6) {
            w[first >> 6] |= from & to;
            return;
        }
        w[first >> 6] |= from;
        for (int i = (first >> 6) + 1; i < last >> 6; ++i) w[i] = ~Word{0};
        w[last >> 6] |= to;
    }
    // Calls f(first, last) for every maximal run of ones. REQUIRES: the last position is 0.
    template <class F>
    void forEachRun(int l, const F& f) const {
        const Word* w = line(l);
        Word carry = 0;
        int first = -1;
        for (int i = 0; i < wordCount_; ++i) {
            // Ones where a run starts and one behind where it ends.
            Word edges = w[i] ^ (w[i] << 1 | carry);
            carry = w[i] >> 63;
            for (; edges != 0; edges &= edges - 1) {
                const int at = 64 * i + std::countr_zero(edges);
                if (first < 0) {
                    first = at;
                } else {
                    f(first, at - 1);
                    first = -1;
                }
            }
        }
    }

    void putLeaf(int leaf, const LeafLines& lines) {
        for (int l = 0; l < kLinesPerLeaf; ++l) bytes(l)[leaf] = lines[l];
    }
    LeafLines leaf(int leaf) const {
        LeafLines lines;
        for (int l = 0; l < kLinesPerLeaf; ++l) lines[l] = bytes(l)[leaf];
        return lines;
    }
    void fillLeaf(int leaf, bool value) {
        for (int l = 0; l < kLinesPerLeaf; ++l) bytes(l)[leaf] = value ? 0xFF : 0;
    }

  private:
    std::uint8_t* bytes(int l) { return reinterpret_cast<std::uint8_t*>(line(l)); }
    const std::uint8_t* bytes(int l) const { return reinterpret_cast<const std::uint8_t*>(line(l)); }

    int wordCount_ = 0;
    std::vector<Word> words_;
};

}  // namespace isowave::wavelets
