// Options that filters and curve-levels share.
#pragma once

#include <optional>
#include <string>

#include "tools/command.h"

namespace isowave::tools {

void declareMask(OptionList& options, std::optional<std::string>& mask);
void declareWidth(OptionList& options, std::optional<int>& width);

}  // namespace isowave::tools
