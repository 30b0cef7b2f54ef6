#include "wavelets/line_values.h"

#include <bit>

#include "wavelets/interval/blocks.h"

// Line 8a + b of a leaf, a and b the coordinates on the two other axes in ascending order. A block is the
// eight lines of one a: for z its rows are rows of the leaf (x = a, y = b); for y they are those of x = a,
// transposed; for x those of y = a, 64 values apart, transposed.

namespace isowave::wavelets {
namespace {

constexpr int kRow = kLeafDim, kPlane = kLeafDim * kLeafDim;

struct BlockPlace {
    int at, apart;  // of the block's first row of eight in a leaf, and from one row to the next
    bool transposed;
};
ISOWAVE_INLINE BlockPlace placeOf(int axis, int a) {
    return axis == 0 ? BlockPlace{a * kRow, kPlane, true} : BlockPlace{a * kPlane, kRow, axis == 1};
}

// The eight bits of `words` that belong to row b of block a.
ISOWAVE_INLINE int bitsOf(const LeafWords& words, int axis, int a, int b) {
    return static_cast<int>((axis == 0 ? words[b] >> 8 * a : words[a] >> 8 * b) & 0xFF);
}

// Lane i: whether bit i is set.
ISOWAVE_INLINE void spread(int bits, Ints8& mask) {
    const Ints8 each = {1, 2, 4, 8, 16, 32, 64, 128};
    mask = ((each & bits) != 0);
}

ISOWAVE_INLINE void takeBlocks(const float* line0, std::size_t apart, int axis, const LeafWords& known,
                               const LeafWords& inside, float K, float* values) {
    const auto k = std::bit_cast<std::int32_t>(K);
    constexpr auto kSign = std::int32_t(0x80000000);
    for (int a = 0; a < kLeafDim; ++a) {
        Float8 r[kBlock];
        for (int b = 0; b < kBlock; ++b) load(line0 + std::size_t(kBlock * a + b) * apart, r[b]);
        const BlockPlace place = placeOf(axis, a);
        if (place.transposed) transpose(r);
        for (int b = 0; b < kBlock; ++b) {
            Ints8 isKnown, isInside;
            spread(bitsOf(known, axis, a, b), isKnown);
            spread(bitsOf(inside, axis, a, b), isInside);
            const Float8 unknown = (Float8)(k ^ (isInside & kSign));
            store(isKnown ? r[b] : unknown, values + place.at + b * place.apart);
        }
    }
}

}  // namespace

void LineValues::reset(int leafCount) {
    stride_ = std::size_t(leafCount + 1) | 1;
    if (rows_.size() < kLinesPerLeaf * stride_) rows_.resize(kLinesPerLeaf * stride_);
}

void LineValues::fillLeaf(int k, float value) {
    for (int l = 0; l < kLinesPerLeaf; ++l)
        for (float& v : rows_[std::size_t(l) * stride_ + k].values) v = value;
}

ISOWAVE_FOUR void LineValues::putLeafByFour(int k, int axis, const float* values) {
    Row* row = rows_.data() + k;
    for (int a = 0; a < kLeafDim; ++a) {
        const BlockPlace place = placeOf(axis, a);
        Float8 r[kBlock];
        for (int b = 0; b < kBlock; ++b) load(values + place.at + b * place.apart, r[b]);
        if (place.transposed) transpose(r);
        for (int b = 0; b < kBlock; ++b, row += stride_) store(r[b], row->values);
    }
}

ISOWAVE_FOUR void LineValues::takeLeafByFour(int k, int axis, const LeafWords& known, const LeafWords& inside,
                                             float K, float* values) const {
    takeBlocks(rows_[k].values, stride_ * kRow, axis, known, inside, K, values);
}
ISOWAVE_EIGHT void LineValues::takeLeafByEight(int k, int axis, const LeafWords& known,
                                               const LeafWords& inside, float K, float* values) const {
    takeBlocks(rows_[k].values, stride_ * kRow, axis, known, inside, K, values);
}

void LineValues::putLeaf(int k, int axis, const float* values) {
    if (vectors_ != Vectors::two) return putLeafByFour(k, axis, values);
    for (int l = 0; l < kLinesPerLeaf; ++l) {
        const BlockPlace place = placeOf(axis, l / kBlock);
        float* line = rows_[std::size_t(l) * stride_ + k].values;
        for (int i = 0; i < kLeafDim; ++i)
            line[i] = place.transposed ? values[place.at + i * place.apart + l % kBlock]
                                       : values[place.at + l % kBlock * place.apart + i];
    }
}

void LineValues::takeLeaf(int k, int axis, const LeafWords& known, const LeafWords& inside, float K,
                          float* values) const {
    if (vectors_ == Vectors::eight) return takeLeafByEight(k, axis, known, inside, K, values);
    if (vectors_ == Vectors::four) return takeLeafByFour(k, axis, known, inside, K, values);
    fillBySign(inside, K, values);
    for (int l = 0; l < kLinesPerLeaf; ++l) {
        const BlockPlace place = placeOf(axis, l / kBlock);
        const float* line = rows_[std::size_t(l) * stride_ + k].values;
        for (int i = 0; i < kLeafDim; ++i) {
            const int at =
                place.at + (place.transposed ? i * place.apart + l % kBlock : l % kBlock * place.apart + i);
            if (known[at / kPlane] >> at % kPlane & 1) values[at] = line[i];
        }
    }
}

}  // namespace isowave::wavelets
