// Man pages, made from what the commands declare.
#pragma once

#include <map>
#include <string>

#include "tools/commands.h"

namespace isowave::tools {

// isowave(1) and one page a subcommand, isowave-lod(1): name of the file -> its text, for man(7) macros.
std::map<std::string, std::string> manPages(const Commands& commands);

}  // namespace isowave::tools
