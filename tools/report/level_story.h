// A level in one line: what it has lost, closed, torn and moved.
#pragma once

#include <array>
#include <string>

#include "isowave/ladder.h"

namespace isowave::tools {

// "level 2 (0.8 mm): 36 -> 27 handles, 13 -> 5 parts; holes closed up to radius ...". unit: " mm" or "".
std::string storyText(const LevelReport& level, const std::string& unit);

// "0.957x0.957x1.5", or one number when all are the same.
std::string voxelText(const std::array<double, 3>& spacing);

}  // namespace isowave::tools
