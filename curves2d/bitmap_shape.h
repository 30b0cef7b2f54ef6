// Grey values of an image -> what is inside: the shape that a field is fitted to.
#pragma once

#include <filesystem>
#include <string>

#include "curves2d/fit.h"

namespace isowave::curves2d {

// One number a pixel, row by row from the top; pixel (x, y) is lattice point (x, y), its middle.
struct Bitmap {
    std::int32_t width = 0, height = 0;
    std::vector<float> values;
    bool isOpacity = false;  // the values: of a drawing on transparent ground

    float at(std::int32_t x, std::int32_t y) const {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

struct ValueRange {
    float low, high;
    bool twoValues;  // a mask: no other value occurs
};
ValueRange valueRange(const Bitmap& bitmap);

// PNG, TIFF, BMP, PGM and PBM, by their first bytes: grey values as stored, colours and opacity as luminance() of
// io/picture has them, laid on white; where the whole border is transparent (less than half opaque), the opacity itself. Throws InputError: not an image, truncated, zero size, several pages, NaN.
Bitmap readBitmap(const std::filesystem::path& path);

// Throws InputError: the first pixel that is NaN or infinite, and how many are.
void refuseNotFinite(const std::string& name, const Bitmap& bitmap);

// Whether all pixels of the border exceed `iso`, and some others do not: these are a drawing, and the border is its ground.
bool hasLightGround(const Bitmap& bitmap, double iso);

// Inside is where the value exceeds `iso` (with `invert`: where it does not). What touches the border of the
// image is closed half a pixel outside it. boundary: the iso line of the bilinear interpolation, in chords.
// name: for the message. Throws InputError when every pixel lies on one side (says the range) unless the
// image is full, which is a rectangle.
Shape shapeOf(const Bitmap& bitmap, double iso, bool invert, const std::string& name);

}  // namespace isowave::curves2d
