// Quantised control points, coded by prediction and mixed contexts.
//
// A residual q - guess is coded as: zero? negative? larger than 1, 2, ... 14? and an Exp-Golomb code beyond. Eleven models are mixed
// for each of these bits: the size of earlier residuals; copies of the neighbours at z - 1, y - 1, x - 1 and all three; columns;
// and what followed the last 5 or 12 indices where they occurred before.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compress/coder/predictor.h"
#include "compress/coder/quantiser.h"

namespace isowave::compress {

// What all chunks of a file share.
struct IndexModel {
    const Lattice& lattice;
    const Quantiser& quantiser;
    const Weights& weights;
    std::int32_t outside;  // the index that stands for an unknown point outside
};

// Planes begin .. end - 1 of the lattice, by themselves: nothing of other planes is looked at. indices: of all points; left as
// they are.
std::string encodeIndices(const IndexModel& model, int begin, int end, std::vector<std::int32_t>& indices);
// Throws std::runtime_error when the bytes cannot have come from encodeIndices().
void decodeIndices(const IndexModel& model, int begin, int end, std::string_view bytes,
                   std::vector<std::int32_t>& indices);

}  // namespace isowave::compress
