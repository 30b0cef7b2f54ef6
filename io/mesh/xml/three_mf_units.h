// The units that a 3MF model may be in (Core Specification 1.3, 3.4.1: ST_Unit).
#pragma once

#include <string_view>

namespace isowave {

struct ThreeMfUnit {
    std::string_view name;
    double millimetres;
};
inline constexpr ThreeMfUnit kThreeMfUnits[] = {{"millimeter", 1}, {"micron", 1e-3}, {"centimeter", 10},
                                                {"inch", 25.4},    {"foot", 304.8},  {"meter", 1000}};

}  // namespace isowave
