// isowave help, isowave completion: the declarations of all commands in words.
#include "isowave/error.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/help.h"

namespace isowave::tools {
namespace {

class Help : public Command {
  public:
    Help() : Command({"help", "[COMMAND]", "this overview, or the options of one subcommand", ""}) {
        options_.flag("--markdown", "everything, as markdown", markdown_);
    }

    int run(Console& console) override {
        const Commands commands = allCommands();
        if (markdown_)
            console.print(markdownHelp(commands));
        else if (arguments.empty())
            console.print(overview(commands));
        else
            console.print(helpFor(named(commands)));
        return 0;
    }

  private:
    const Command& named(const Commands& commands) const {
        const std::string name = arguments[0].string();
        if (const Command* command = findCommand(commands, name)) return *command;
        throw UsageError("help: there is no subcommand '" + name + "'; see isowave help");
    }

    bool markdown_ = false;
};

class Completion : public Command {
  public:
    Completion()
        : Command({"completion", "bash",
                   "a completion script for the shell: source <(isowave completion bash)", ""}) {}

    int run(Console& console) override {
        if (arguments[0] != "bash")
            throw UsageError("completion: '" + arguments[0].string() +
                             "' is not a shell that is known; bash is");
        console.print(bashCompletion(allCommands()));
        return 0;
    }
};

}  // namespace

std::unique_ptr<Command> helpCommand() { return std::make_unique<Help>(); }
std::unique_ptr<Command> completionCommand() { return std::make_unique<Completion>(); }

}  // namespace isowave::tools
