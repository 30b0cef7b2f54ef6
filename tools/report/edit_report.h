// What `isowave edit` tells.
#pragma once

#include <string>
#include <vector>

#include "isowave/pyramid.h"

namespace isowave::tools {

struct EditTale {
    std::string input, output;
    EditReport report;
    std::vector<std::string> remarks;
};
std::string jsonOf(const EditTale& tale);
std::string textOf(const EditTale& tale);

}  // namespace isowave::tools
