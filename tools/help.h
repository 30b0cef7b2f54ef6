// Texts made from what the commands declare.
#pragma once

#include <string>

#include "tools/commands.h"

namespace isowave::tools {

// `isowave --help`: the subcommands and the exit codes.
std::string overview(const Commands& commands);

// `isowave lod --help`.
std::string helpFor(const Command& command);

// `isowave help --markdown`: the section "Command line" of docs/interfaces.md.
std::string markdownHelp(const Commands& commands);

// `isowave completion bash`.
std::string bashCompletion(const Commands& commands);

}  // namespace isowave::tools
