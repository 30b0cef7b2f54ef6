// Control points, coded to the bit.
//
// A value is taken as the integer that orders floats. First: is it one of a few candidates? Plane faces and repeated features give
// exactly the same control points again and again: what followed the last 6 values, what stood beside the same three
// neighbours, and the neighbours themselves. If not: the difference from a prediction, as its number of bits, its sign, and the
// bits, of which only the highest are worth a model; the rest is the noise of the fit.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compress/coder/predictor.h"

namespace isowave::compress {

struct FloatModel {
    const Lattice& lattice;
    const Weights& weights;
    float K;
};

// Of the values, for all chunks of a file.
Weights fitFloatWeights(const Lattice& lattice, const std::vector<float>& values, float K);

// As encodeIndices() and decodeIndices().
std::string encodeFloats(const FloatModel& model, int begin, int end, std::vector<float>& values);
void decodeFloats(const FloatModel& model, int begin, int end, std::string_view bytes,
                  std::vector<float>& values);

}  // namespace isowave::compress
