// PGM and PBM, in text (P1, P2) and in bytes (P4, P5).
#pragma once

#include <string>
#include <string_view>

#include "io/picture/picture.h"

namespace isowave {

bool isPnm(std::string_view bytes);

// Values as stored, in 8 bits when the largest possible one is below 256, otherwise in 16; PBM: black 0, white 255.
// `name` stands in messages. Throws InputError: truncated, no number where one should be, a value above the largest.
Picture readPnm(std::string_view bytes, const std::string& name);

}  // namespace isowave
