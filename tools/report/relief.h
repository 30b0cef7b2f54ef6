// What `isowave relief` says, as text and as JSON (docs/interfaces.md).
#pragma once

#include <string>

#include "isowave/subdivision.h"
#include "tools/report/json.h"

namespace isowave::tools {

std::string textOf(const subdivision::ReliefReport& report);
std::string jsonOf(const subdivision::ReliefReport& report);

}  // namespace isowave::tools
