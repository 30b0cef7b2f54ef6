// A picture or a grid of numbers as its file holds it, and the two ways in which programs look at one: as grey
// values and as numbers. The readers and writers of the formats stand beside it: png.h, tiff.h, bmp.h, pnm.h,
// npy.h, asc.h; jpeg.h is a reader alone.
//
// Transparency. A reader keeps opacity as the last channel and composes nothing. A drawing (luminance()) is laid
// on white, the colour of paper. A grid of heights has no such ground: heights() refuses a sample that is not
// opaque, as it refuses one that is not a number.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/value_type.h"

namespace isowave {

struct Picture {
    std::int64_t width = 0, height = 0;
    int channels = 1;                   // of a pixel
    bool isColour = false;              // the first three are red, green, blue; otherwise they are numbers
    bool hasOpacity = false;            // the last one is opacity: 0 clear, fullValue() opaque
    ValueType type = ValueType::uint8;  // of the samples here
    int bits = 8;         // of a sample in the file; those of 1, 2 and 4 are spread over 0 .. 255
    int pages = 1;        // of the file; the first one is here
    bool isSrgb = false;  // its file says that the values are meant for a screen
    std::optional<std::array<double, 2>> pixelSize = {};  // mm
    std::optional<double> noData =
        {};  // the sample that its file says stands for none, as GeoTIFF has it; numbers only
    // Red, green, blue of each colour, where the samples are places in a palette and not colours.
    std::string palette = {};
    // Row by row from the top, the channels of a pixel together, in this machine's byte order.
    std::vector<std::byte> samples = {};

    std::size_t sampleCount() const { return samples.size() / sizeOf(type); }
    // REQUIRES: sizeof(T) == sizeOf(type).
    template <class T>
    std::span<const T> as() const {
        return {reinterpret_cast<const T*>(samples.data()), sampleCount()};
    }
    double fullValue() const;  // the largest integer of the type; 1 of a floating-point type
};

// For readers. Throws InputError for a picture without pixels and for more than 2^31 of them.
void checkSize(const Picture& picture, const std::string& name);
// Gives `picture` its width x height x channels samples, all 0. In the file a pixel takes `bitsEach` bits of `stored`
// bytes in all, of which none becomes more than `expansion` bytes. Throws InputError, before any memory is taken, as
// checkSize() does and for more pixels than the file can hold.
void allocate(Picture& picture, const std::string& name, int bitsEach, std::size_t stored, double expansion);

// One number a pixel: grey as stored, colours by Rec. 601 (0.299 R + 0.587 G + 0.114 B), laid on white where they
// are not opaque.
std::vector<float> luminance(const Picture& picture);

// The samples of a grid without its opacity, heightChannels() a pixel; colours as in luminance(). Throws InputError for
// a sample that is not opaque, and says where the first one is.
std::vector<double> heights(const Picture& picture, const std::string& name);
int heightChannels(const Picture& picture);

}  // namespace isowave
