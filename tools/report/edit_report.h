// What `isowave edit` tells.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isowave/pyramid.h"

namespace isowave::tools {

struct EditTale {
    std::optional<std::string> input, output;  // files; nothing where there are none
    EditReport report;
    std::vector<std::string> remarks;
};
std::string jsonOf(const EditTale& tale);
std::string textOf(const EditTale& tale);  // REQUIRES: output

}  // namespace isowave::tools
