#include "tools/cli.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "isowave/error.h"

namespace isowave::tools {
namespace {

// One subcommand as CLI11 sees it, and where CLI11 leaves what it found.
struct ParsedCommand {
    Command* command = nullptr;
    CLI::App* app = nullptr;
    std::vector<std::pair<const Option*, CLI::Option*>> options;
    std::vector<std::string> arguments;
    bool help = false;
};

std::unique_ptr<ParsedCommand> declare(CLI::App& app, Command& command) {
    auto parsed = std::make_unique<ParsedCommand>();
    parsed->command = &command;
    parsed->app = app.add_subcommand(std::string(command.name()), std::string(command.description().summary));
    parsed->app->set_help_flag();  // ours, made from the declarations
    parsed->app->add_flag("-h,--help", parsed->help);
    parsed->app->add_option("arguments", parsed->arguments)->type_size(1)->expected(0, 1 << 20);
    for (const Option& option : command.options().all()) {
        const std::string names(option.names);
        parsed->options.emplace_back(&option, option.isFlag() ? parsed->app->add_flag(names)
                                                              : parsed->app->add_option(names)->expected(1));
    }
    return parsed;
}

std::string oneLine(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

// "lod: expects INPUT, got 2 arguments (a, b)"
void takeArguments(const ParsedCommand& parsed) {
    Command& command = *parsed.command;
    const std::string name(command.name()), expected(command.description().arguments);
    const auto found = static_cast<int>(parsed.arguments.size());
    const bool enough =
        command.takesMore() ? found >= command.argumentCount() : found == command.argumentCount();
    if (enough || (expected.front() == '[' && found == 0)) {
        for (const std::string& argument : parsed.arguments) {
            if (argument.empty()) throw UsageError(name + ": the name of a file is empty");
            command.arguments.emplace_back(argument);
        }
        return;
    }
    std::string list;
    for (const std::string& argument : parsed.arguments) list += (list.empty() ? "" : ", ") + argument;
    throw UsageError(name + ": expects " + expected + ", got " + (found == 0 ? "nothing" : list) +
                     "; see isowave " + name + " --help");
}

void takeOptions(const ParsedCommand& parsed) {
    for (const auto& [option, found] : parsed.options) {
        if (found->count() == 0) continue;
        try {
            option->apply(option->isFlag() ? std::string() : found->as<std::string>());
        } catch (const UsageError& error) {
            throw UsageError(std::string(option->longName()) + ": " + error.what());
        }
    }
}

// Options come first: of "--iso -o out", -o is no number, and out is no argument too many.
void take(const ParsedCommand& parsed) {
    takeOptions(parsed);
    takeArguments(parsed);
    if (parsed.command->needsOutput() && !parsed.command->hasOutput())
        throw UsageError(std::string(parsed.command->name()) + ": -o is missing; say where the result goes");
}

void parse(CLI::App& app, int argc, const char* const* argv) {
    const bool named = argc > 1 && argv[1][0] != '-';
    const std::string help =
        "; see isowave " + (named ? std::string(argv[1]) + " " : std::string()) + "--help";
    try {
        app.parse(argc, argv);
    } catch (const CLI::ArgumentMismatch& error) {  // "--iso: At Most 1 required but received 2"
        const std::string text = oneLine(error.what());
        throw UsageError(text.substr(0, text.find(':')) + ": expects one value, given once" + help);
    } catch (const CLI::ParseError& error) {
        throw UsageError(oneLine(error.what()) + help);
    }
}

std::string namesOf(const Commands& commands) {
    std::string list;
    for (const auto& command : commands) list += (list.empty() ? "" : ", ") + std::string(command->name());
    return list;
}

// CLI11 would call every word of the line an argument that it did not expect.
void refuseUnknownCommand(const Commands& commands, int argc, const char* const* argv) {
    if (argc < 2 || argv[1][0] == '-' || findCommand(commands, argv[1])) return;
    throw UsageError("there is no subcommand '" + std::string(argv[1]) + "'; there are " + namesOf(commands) +
                     "; see isowave --help");
}

}  // namespace

Invocation parseCommandLine(const Commands& commands, int argc, const char* const* argv) {
    CLI::App app;
    app.set_help_flag();
    Invocation invocation;
    app.add_flag("-h,--help", invocation.help);
    app.add_flag("--version", invocation.version);
    app.require_subcommand(0, 1);
    std::vector<std::unique_ptr<ParsedCommand>> parsed;
    for (const auto& command : commands) parsed.push_back(declare(app, *command));
    refuseUnknownCommand(commands, argc, argv);
    parse(app, argc, argv);
    for (const auto& candidate : parsed) {
        if (!candidate->app->parsed()) continue;
        if (!candidate->help) take(*candidate);
        return {candidate->command, candidate->help, false};
    }
    if (!invocation.help && !invocation.version)
        throw UsageError("a subcommand is missing: " + namesOf(commands) + "; see isowave --help");
    return invocation;
}

}  // namespace isowave::tools
