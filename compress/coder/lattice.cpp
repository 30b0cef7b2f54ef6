#include "compress/coder/lattice.h"

#include <bit>
#include <functional>
#include <numeric>

namespace isowave::compress {
namespace {

constexpr int kSupport = 3;  // a node's control points reach so far beyond its own place

// row |= row moved up by one bit
void orShifted(const std::uint64_t* from, std::uint64_t* to, std::size_t words, int shift) {
    std::uint64_t carry = 0;
    for (std::size_t w = 0; w < words; ++w) {
        to[w] |= (from[w] << shift) | carry;
        carry = shift == 0 ? 0 : from[w] >> (64 - shift);
    }
}

void andShifted(const std::uint64_t* from, std::size_t fromWords, std::uint64_t* to, std::size_t words,
                int shift) {
    for (std::size_t w = 0; w < words; ++w) {
        const std::uint64_t next = w + 1 < fromWords ? from[w + 1] : 0;
        to[w] &= shift == 0 ? from[w] : (from[w] >> shift) | (next << (64 - shift));
    }
}

}  // namespace

BitBox::BitBox(const Size& size)
    : size_(size),
      words_((static_cast<std::size_t>(size[2]) + 63) / 64),
      bits_(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * words_, 0) {}

std::size_t BitBox::count() const {
    return std::transform_reduce(
        bits_.begin(), bits_.end(), std::size_t{0}, std::plus<>(),
        [](std::uint64_t word) { return static_cast<std::size_t>(std::popcount(word)); });
}

BitBox nodesOf(const BitBox& known) {
    const Size& n = known.size();
    BitBox nodes({n[0] - kSupport, n[1] - kSupport, n[2] - kSupport});
    for (int x = 0; x < n[0] - kSupport; ++x)
        for (int y = 0; y < n[1] - kSupport; ++y) {
            std::uint64_t* const to = nodes.row(x, y);
            for (std::size_t w = 0; w < nodes.words(); ++w) to[w] = ~std::uint64_t{0};
            for (int k = 0; k < 64; ++k)
                andShifted(known.row(x + k / 16, y + k / 4 % 4), known.words(), to, nodes.words(), k % 4);
        }
    return nodes;
}

BitBox pointsOf(const BitBox& nodes) {
    const Size& n = nodes.size();
    BitBox known({n[0] + kSupport, n[1] + kSupport, n[2] + kSupport});
    std::vector<std::uint64_t> wide(known.words());
    for (int x = 0; x < n[0]; ++x)
        for (int y = 0; y < n[1]; ++y) {
            wide.assign(known.words(), 0);
            for (std::size_t w = 0; w < nodes.words(); ++w) wide[w] = nodes.row(x, y)[w];
            for (int k = 0; k < 64; ++k)
                orShifted(wide.data(), known.row(x + k / 16, y + k / 4 % 4), known.words(), k % 4);
        }
    return known;
}

Lattice::Lattice(const BitBox& known) : size(known.size()) {
    rowStart.reserve(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) + 1);
    for (int x = 0; x < size[0]; ++x)
        for (int y = 0; y < size[1]; ++y) {
            rowStart.push_back(z.size());
            const std::uint64_t* const row = known.row(x, y);
            for (std::size_t w = 0; w < known.words(); ++w)
                for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1)
                    z.push_back(static_cast<std::int32_t>(64 * w) + std::countr_zero(bits));
        }
    rowStart.push_back(z.size());
}

}  // namespace isowave::compress
