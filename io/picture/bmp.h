// BMP of Windows: 1, 4 and 8 bits with a palette, 24 and 32 bits, uncompressed or with runs of 8 bits (RLE8).
#pragma once

#include <string>
#include <string_view>

#include "io/picture/picture.h"

namespace isowave {

bool isBmp(std::string_view bytes);

// Always colours. Of 32 bits the last 8 are opacity, unless they are 0 everywhere: then they are padding. `name` stands
// in messages. Throws InputError: truncated, of another kind.
Picture readBmp(std::string_view bytes, const std::string& name);

}  // namespace isowave
