// The subcommands, in the order of `isowave help`. Each is declared in the folder of what it works on.
#pragma once

#include <memory>
#include <vector>

#include "tools/command.h"

namespace isowave::tools {

using Commands = std::vector<std::unique_ptr<Command>>;

Commands allCommands();

// nullptr when there is none.
Command* findCommand(const Commands& commands, std::string_view name);

// tools/solids/
std::unique_ptr<Command> lodCommand();
std::unique_ptr<Command> analyseCommand();
std::unique_ptr<Command> packCommand();
std::unique_ptr<Command> editCommand();
std::unique_ptr<Command> meshCommand();
std::unique_ptr<Command> fieldCommand();
std::unique_ptr<Command> infoCommand();
std::unique_ptr<Command> checkCommand();
std::unique_ptr<Command> compareCommand();
// tools/view/
std::unique_ptr<Command> viewCommand();
// tools/subdivision/
std::unique_ptr<Command> filtersCommand();
std::unique_ptr<Command> curveLevelsCommand();
std::unique_ptr<Command> reliefCommand();
std::unique_ptr<Command> reverseCommand();
std::unique_ptr<Command> rebuildCommand();
std::unique_ptr<Command> subdivideCommand();
// tools/curves/
std::unique_ptr<Command> curvesCommand();
// tools/help_command.cpp
std::unique_ptr<Command> helpCommand();
std::unique_ptr<Command> completionCommand();

}  // namespace isowave::tools
