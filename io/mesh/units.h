// Lengths that meshes are measured in.
#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace isowave {

inline constexpr std::array<std::pair<std::string_view, double>, 6> kMetresPerUnit{
    {{"mm", 0.001}, {"cm", 0.01}, {"m", 1}, {"in", 0.0254}, {"ft", 0.3048}, {"angstrom", 1e-10}}};

// 0 for another name.
constexpr double metresPer(std::string_view unit) {
    for (const auto& [name, metres] : kMetresPerUnit)
        if (unit == name) return metres;
    return 0;
}

}  // namespace isowave
