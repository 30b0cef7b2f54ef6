#include "tools/commands.h"

#include <algorithm>

namespace isowave::tools {

Commands allCommands() {
    Commands commands;
    for (const auto& make :
         {lodCommand, analyseCommand, packCommand, editCommand, meshCommand, fieldCommand, infoCommand,
          checkCommand, compareCommand, viewCommand, filtersCommand, curveLevelsCommand, reliefCommand,
          reverseCommand, rebuildCommand, subdivideCommand, curvesCommand, helpCommand, completionCommand})
        commands.push_back(make());
    return commands;
}

Command* findCommand(const Commands& commands, std::string_view name) {
    const auto found = std::find_if(commands.begin(), commands.end(),
                                    [&](const auto& command) { return command->name() == name; });
    return found == commands.end() ? nullptr : found->get();
}

}  // namespace isowave::tools
