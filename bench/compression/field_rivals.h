// Other coders of the control points of a field.
//
// All but OpenVDB's own file leave out which points are known: `mask` says so, and tables add the bytes that a packed solid
// takes for it. Values are in the order of FieldPoints (compress/field_points.h).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "compress/field_points.h"

namespace isowave::bench {

using compress::FieldPoints;
using Values = std::vector<float>;

struct FieldRival {
    std::string name;
    bool mask = true;  // has to be added
    // parameter: the larger, the coarser; a coder without one ignores it.
    std::function<std::string(double parameter)> encode = {};
    std::function<Values(std::string_view bytes, double parameter)> decode = {};
    // decode(encode(parameter)), where there is a quicker way to it; empty: there is none
    std::function<Values(double parameter)> trial = {};
};

// Steps of one size, in the raster order of points, as bytes or as planes of bytes, and xz -9e. Parameter: the step, in K.
FieldRival uniformAndXz(const FieldPoints& points);
// The same with the range of values in 255 steps.
FieldRival eightBitsAndXz(const FieldPoints& points);
// The bytes of floats in four planes, and xz -9e: to the bit.
FieldRival planesAndXz(const FieldPoints& points);
// OpenVDB's file with its Blosc compression, of float32 (to the bit) or of half floats.
FieldRival vdbAndBlosc(const FieldPoints& points, const BSplineField& field, bool half);
// zfp's fixed accuracy on blocks of 4^3 that have known points; unknown ones as the field has them. Parameter: its tolerance, in
// K, of which it takes the power of two below. Without encode where zfp is not installed.
FieldRival zfpBlocks(const FieldPoints& points, const BSplineField& field);

// xz -9e, and back. Throws std::runtime_error.
std::string xz(std::string_view bytes);
std::string unxz(std::string_view bytes, std::size_t size);

}  // namespace isowave::bench
