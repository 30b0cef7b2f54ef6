// isowave help, isowave completion: the table in words.
#include <fmt/format.h>

#include "tools/commands.h"
#include "tools/console.h"
#include "tools/help.h"

namespace isowave::tools {

int runHelp(const Settings& settings, Console& console) {
    if (settings.markdown) {
        console.print(markdownHelp());
        return 0;
    }
    if (settings.files.empty()) {
        console.print(overview());
        return 0;
    }
    const Command* command = findCommand(settings.files[0].string());
    if (!command)
        throw UsageError("help: there is no subcommand '" + settings.files[0].string() +
                         "'; see isowave help");
    console.print(helpFor(*command));
    return 0;
}

int runCompletion(const Settings& settings, Console& console) {
    if (settings.files[0] != "bash")
        throw UsageError("completion: '" + settings.files[0].string() +
                         "' is not a shell that is known; bash is");
    console.print(bashCompletion());
    return 0;
}

}  // namespace isowave::tools
