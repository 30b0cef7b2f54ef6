// Texts made from what the commands declare.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "tools/commands.h"

namespace isowave::tools {

// `isowave --help`: the subcommands and the exit codes.
std::string overview(const Commands& commands);

// `isowave lod --help`.
std::string helpFor(const Command& command);

// `isowave help --markdown`: the section "Command line" of docs/interfaces.md.
std::string markdownHelp(const Commands& commands);

// ---- parts that man pages and completion have too

struct ExitCode {
    int code;
    std::string_view meaning;
};
std::span<const ExitCode> exitCodes();
// "isowave lod INPUT... -o PATH [options]"
std::string usage(const Command& command);
// "-o, --output PATH"
std::string signature(const Option& option);
// The help, and "(default: 4)" where there is one.
std::string explained(const Option& option);
std::string upperFirst(std::string_view text);

}  // namespace isowave::tools
