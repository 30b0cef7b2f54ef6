// What a label image says of one of its labels.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace isowave::imageio {

struct ImageSegment {
    double label = 0;                                        // of its voxels
    std::string name;                                        // one line; may be empty
    std::optional<std::array<std::uint8_t, 3>> colour = {};  // red, green, blue, sRGB
    int layer = 0;                                           // which of several volumes it is in, from 0 on
};

}  // namespace isowave::imageio
