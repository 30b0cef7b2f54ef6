// A leaf's 512 bits as eight words: word x, bit 8y + z. What is known and what is inside, 64 lattice points
// at a time.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "volume/vdb.h"

namespace isowave {

using LeafWords = std::array<std::uint64_t, 8>;
using LeafMask = openvdb::util::NodeMask<3>;

inline bool isEmpty(const LeafWords& words) {
    return std::all_of(words.begin(), words.end(), [](std::uint64_t w) { return w == 0; });
}

inline LeafWords wordsOf(const LeafMask& mask) {
    LeafWords words;
    for (openvdb::Index x = 0; x < 8; ++x) words[x] = mask.getWord<std::uint64_t>(x);
    return words;
}

inline LeafMask maskOf(const LeafWords& words) {
    LeafMask mask;
    for (openvdb::Index x = 0; x < 8; ++x) mask.getWord<std::uint64_t>(x) = words[x];
    return mask;
}

// The values of a shape's leaf.
inline LeafWords insideWordsOf(const openvdb::BoolTree::LeafNodeType& leaf) {
    LeafWords words;
    std::copy_n(leaf.buffer().data(), words.size(), words.begin());
    return words;
}
inline void setInside(openvdb::BoolTree::LeafNodeType& leaf, const LeafWords& words) {
    std::copy(words.begin(), words.end(), leaf.buffer().data());
}

// Where 512 values in a leaf's order are negative.
template <class Value>
LeafWords negativeWordsOf(const Value* values) {
    LeafWords words{};
    for (std::uint64_t& word : words)
        for (int i = 0; i < 64; ++i) word |= std::uint64_t(*values++ < 0) << i;
    return words;
}

// 512 values, -K where inside and +K elsewhere. By the sign bits of four values at a time: which bits are set
// no branch predictor can know.
inline void fillBySign(const LeafWords& inside, float K, float* values) {
    static constexpr auto kSigns = [] {
        std::array<std::array<std::uint32_t, 4>, 16> signs{};
        for (std::uint32_t four = 0; four < 16; ++four)
            for (int i = 0; i < 4; ++i) signs[four][i] = (four >> i & 1) << 31;
        return signs;
    }();
    const auto plus = std::bit_cast<std::uint32_t>(K);
    for (std::uint64_t word : inside)
        for (int row = 0; row < 16; ++row, word >>= 4, values += 4)
            for (int i = 0; i < 4; ++i) values[i] = std::bit_cast<float>(plus ^ kSigns[word & 15][i]);
}

}  // namespace isowave
