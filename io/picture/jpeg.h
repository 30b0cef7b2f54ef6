// JPEG, by libjpeg: baseline and progressive, 8 bits. Read, never written: it is lossy.
#pragma once

#include <string>
#include <string_view>

#include "io/picture/picture.h"

namespace isowave {

bool isJpeg(std::string_view bytes);

// One channel of grey values as they are decoded, or the three colours. What a density of pixels says is passed over: cameras and
// programs put 72 or 96 a inch there.
// `name` stands in messages; libjpeg prints nothing. Throws InputError: truncated, damaged, CMYK, more than 100 scans (libjpeg would
// take hours over some), 12 bits, lossless.
Picture readJpeg(std::string_view bytes, const std::string& name);

}  // namespace isowave
