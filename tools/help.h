// Texts made from the table of commands.h.
#pragma once

#include <string>

#include "tools/commands.h"

namespace isowave::tools {

// `isowave --help`: the subcommands and the exit codes.
std::string overview();

// `isowave lod --help`.
std::string helpFor(const Command& command);

// `isowave help --markdown`: the section "Command line" of docs/interfaces.md.
std::string markdownHelp();

// `isowave completion bash`.
std::string bashCompletion();

}  // namespace isowave::tools
