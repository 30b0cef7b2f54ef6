// Options that reverse, rebuild and subdivide share.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tools/command.h"

namespace isowave::tools {

void declareDepth(OptionList& options, std::string_view fallback, std::string_view help, int& depth);
void declareScheme(OptionList& options, std::string& scheme);
void declareCrease(OptionList& options, std::optional<double>& angle);  // degrees

}  // namespace isowave::tools
