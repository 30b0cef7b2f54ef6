// What `isowave pack` tells.
#pragma once

#include <string>

#include "isowave/pyramid.h"

namespace isowave::tools {

struct PackStory {
    std::string input, output;
    PackOptions options;
    PackReport report;
};
std::string jsonOf(const PackStory& story);
std::string textOf(const PackStory& story);

}  // namespace isowave::tools
