// TIFF and BigTIFF, by libtiff.
#pragma once

#include <string>
#include <string_view>

#include "io/picture/picture.h"

namespace isowave {

bool isTiff(std::string_view bytes);

// The first page; `pages` counts those that are neither thumbnails nor masks. Integers of 8 to 64 bits and floats of 32
// and 64 stay as they are, 1, 2 and 4 bits are spread over 0 .. 255, palettes become colours of 16 bits, and where 0 is
// white the values are turned over. One channel beyond grey or colours is opacity; colours that were multiplied with
// it are divided. Whatever else libtiff can show (YCbCr, CMYK, Lab) becomes colours of 8 bits.
// `name` stands in messages; libtiff prints nothing. Throws InputError: truncated, damaged, of a kind that is not read.
Picture readTiff(std::string_view bytes, const std::string& name);

}  // namespace isowave
