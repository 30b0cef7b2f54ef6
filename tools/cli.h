// argv -> a subcommand with its arguments and options put in.
#pragma once

#include "tools/commands.h"

namespace isowave::tools {

struct Invocation {
    Command* command = nullptr;  // one of `commands`; nullptr: `isowave --help` or `isowave --version`
    bool help = false, version = false;
    bool verbose = false;  // with --version: what it is built of
};

// Throws UsageError with one line that names the argument.
Invocation parseCommandLine(const Commands& commands, int argc, const char* const* argv);

}  // namespace isowave::tools
