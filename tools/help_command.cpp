// isowave help, isowave completion: the declarations of all commands in words, as man pages and for shells.
#include "isowave/error.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/help.h"
#include "tools/output.h"
#include "tools/shell/completion.h"
#include "tools/shell/man_page.h"
#include "tools/similar.h"

namespace isowave::tools {
namespace {

class Help : public Command {
  public:
    Help() : Command({"help", "[COMMAND]", "this overview, or the options of one subcommand", ""}) {
        options_.flag("--markdown", "everything, as markdown", markdown_);
        options_.result("--man", "PATH", "man pages of all commands go into this folder", man_);
    }

    int run(Console& console) override {
        const Commands commands = allCommands();
        if (man_)
            writeManPages(commands);
        else if (markdown_)
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
        std::vector<std::string_view> names;
        for (const auto& command : commands) names.push_back(command->name());
        throw UsageError("help: there is no subcommand '" + name + "'" +
                         suggestion(name, names, "isowave help"));
    }

    void writeManPages(const Commands& commands) const {
        OutputFolder out(*man_);
        writeFiles(out, manPages(commands));
        out.commit();
    }

    bool markdown_ = false;
    std::optional<std::filesystem::path> man_;
};

class Completion : public Command {
  public:
    Completion()
        : Command({"completion", "SHELL",
                   "a completion script for bash or zsh: source <(isowave completion bash)", ""}) {}

    int run(Console& console) override {
        const std::string shell = arguments[0].string();
        if (shell != "bash" && shell != "zsh")
            throw UsageError("completion: '" + shell + "' is not a shell that is known; bash and zsh are");
        const Commands commands = allCommands();
        console.print(shell == "bash" ? bashCompletion(commands) : zshCompletion(commands));
        return 0;
    }
};

}  // namespace

std::unique_ptr<Command> helpCommand() { return std::make_unique<Help>(); }
std::unique_ptr<Command> completionCommand() { return std::make_unique<Completion>(); }

}  // namespace isowave::tools
