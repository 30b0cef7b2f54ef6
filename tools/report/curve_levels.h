// What `isowave curve-levels` says, as text and as JSON (docs/interfaces.md).
#pragma once

#include <string>
#include <vector>

#include "isowave/subdivision.h"
#include "tools/report/json.h"

namespace isowave::tools {

// A table for people, with the mean ratios beside the row "Coast" of O's Table 1 when schemes were compared.
std::string textOf(const subdivision::CurveReport& report);
std::string jsonOf(const subdivision::CurveReport& report);

// Curves that are too short for the levels, or for the limit positions, that were asked for: a line each, or nothing.
std::vector<std::string> remarks(const subdivision::CurveReport& report);

}  // namespace isowave::tools
