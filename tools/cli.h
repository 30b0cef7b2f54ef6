// argv -> a subcommand and its settings, as the table of commands.h declares them.
#pragma once

#include "tools/commands.h"

namespace isowave::tools {

struct Invocation {
    const Command* command = nullptr;  // nullptr: `isowave --help` or `isowave --version`
    bool version = false;
    Settings settings;
};

// Throws UsageError with one line that names the argument.
Invocation parseCommandLine(int argc, const char* const* argv);

}  // namespace isowave::tools
