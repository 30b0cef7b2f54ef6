// PNG, by libpng. Nothing is done to gamma.
#pragma once

#include <string>
#include <string_view>

#include "io/picture/picture.h"

namespace isowave {

bool isPng(std::string_view bytes);

// 8 and 16 bits; 1, 2 and 4 bits are spread over 0 .. 255; palettes become colours; a colour that is declared clear
// (tRNS) becomes opacity. pixelSize: the two numbers of sCAL, which ITK writes in mm whatever unit it names.
// `name` stands in messages. Throws InputError: truncated, a chunk with a wrong checksum, damaged.
Picture readPng(std::string_view bytes, const std::string& name);

// The same for volumes: what has a palette is one number a pixel, as a TIFF is (io/picture/tiff.h). Of colours that is the place in the
// palette, a label, whatever it looks like; where all of them are grey, the grey value.
Picture readPngNumbers(std::string_view bytes, const std::string& name);
// Without samples.
Picture readPngNumbersHeader(std::string_view bytes, const std::string& name);

// The file. REQUIRES: uint8 or uint16; 1 or 2 channels, or 3 or 4 that are colours, an even number with opacity.
// Throws OperationError.
std::string pngBytes(const Picture& picture);

}  // namespace isowave
