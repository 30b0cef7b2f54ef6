// A leaf's 512 bits as eight words: word x, bit 8y + z. What is known and what is inside, 64 lattice points at a time.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "volume/vdb.h"

namespace isowave {

using LeafWords = std::array<std::uint64_t, 8>;
using LeafMask = openvdb::util::NodeMask<3>;

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

// 512 values, -K where inside and +K elsewhere.
inline void fillBySign(const LeafWords& inside, float K, float* values) {
    for (const std::uint64_t word : inside) {
        if (word == 0 || ~word == 0)
            std::fill_n(values, 64, word ? -K : K);
        else
            for (int i = 0; i < 64; ++i) values[i] = word >> i & 1 ? -K : K;
        values += 64;
    }
}

}  // namespace isowave
