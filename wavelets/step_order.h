// The order of steps (isowave/solid.h: StepOrder) as files have it.
//
//   forVoxels   rounds, each of them a level: of the sets "the shortest axis" and "the two shortest" the one is halved that leaves the
//               smallest ratio of the longest to the shortest edge, the smaller set where both leave the same. The rounds end
//               where the ratio is below the factor or none makes it smaller, at a ratio below 2 in any case.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "isowave/solid.h"

namespace isowave::wavelets {

// The first levels, "xy xy"; empty where every level halves x, y and z.
std::string textOf(const StepOrder& order);

// The way back. Nothing for a text that is none, that names an axis twice in a level ("xx"), or has more than kMostHalvings levels:
// coordinates have 32 bits.
inline constexpr std::size_t kMostHalvings = 32;
std::optional<StepOrder> orderOf(std::string_view text);

}  // namespace isowave::wavelets
