// The values of a column of leaves, line by line: the values of a line are contiguous, whatever the axis.
#pragma once

#include <cstddef>
#include <vector>

#include "base/vectors.h"
#include "volume/leaf_words.h"
#include "wavelets/line_bits.h"

namespace isowave::wavelets {

class LineValues {
  public:
    // Tests choose narrower vectors.
    explicit LineValues(Vectors vectors = widestVectors()) : vectors_(vectors) {}

    // Leaves 0 .. leafCount - 1, positions 0 .. 8 leafCount - 1. Values are not initialised. Keeps its
    // memory.
    void reset(int leafCount);

    // Values of line l, which begins at position 0; behind its last are kLeafDim more that belong to no line.
    float* line(int l) { return rows_[std::size_t(l) * stride_].values; }
    const float* line(int l) const { return rows_[std::size_t(l) * stride_].values; }

    // values: 512 in a leaf's order.
    void putLeaf(int k, int axis, const float* values);
    void fillLeaf(int k, float value);
    // Where a value is not known: K with the sign of `inside`.
    void takeLeaf(int k, int axis, const LeafWords& known, const LeafWords& inside, float K,
                  float* values) const;

  private:
    struct alignas(kLeafDim * sizeof(float)) Row {
        float values[kLeafDim];
    };

    void putLeafByFour(int k, int axis, const float* values);
    void takeLeafByFour(int k, int axis, const LeafWords& known, const LeafWords& inside, float K,
                        float* values) const;
    void takeLeafByEight(int k, int axis, const LeafWords& known, const LeafWords& inside, float K,
                         float* values) const;

    Vectors vectors_;
    // Rows from one line to the next: odd, so that lines do not fall into the same cache sets.
    std::size_t stride_ = 0;
    std::vector<Row> rows_;
};

}  // namespace isowave::wavelets
