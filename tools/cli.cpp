#include "tools/cli.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

namespace isowave::tools {
namespace {

// One subcommand as CLI11 sees it, and where CLI11 leaves what it found.
struct ParsedCommand {
    const Command* command;
    CLI::App* app;
    std::vector<std::pair<const Option*, CLI::Option*>> options;
    std::vector<std::string> arguments;
    bool help = false;
};

std::unique_ptr<ParsedCommand> declare(CLI::App& app, const Command& command) {
    auto parsed = std::make_unique<ParsedCommand>();
    parsed->command = &command;
    parsed->app = app.add_subcommand(std::string(command.name), std::string(command.summary));
    parsed->app->set_help_flag();  // ours, made from the table
    parsed->app->add_flag("-h,--help", parsed->help);
    parsed->app->add_option("arguments", parsed->arguments)->type_size(1)->expected(0, 1 << 20);
    for (const Option& option : options())
        if (option.belongsTo(command.name)) {
            const std::string names(option.names);
            parsed->options.emplace_back(&option, option.isFlag()
                                                      ? parsed->app->add_flag(names)
                                                      : parsed->app->add_option(names)->expected(1));
        }
    return parsed;
}

std::string oneLine(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

// "lod: expects INPUT, got 2 arguments (a, b)"
void takeArguments(const ParsedCommand& parsed, Settings& settings) {
    const Command& command = *parsed.command;
    const auto found = static_cast<int>(parsed.arguments.size());
    const bool optional = command.arguments.front() == '[';
    if (found == command.argumentCount() || (optional && found == 0)) {
        for (const std::string& argument : parsed.arguments) {
            if (argument.empty())
                throw UsageError(std::string(command.name) + ": the name of a file is empty");
            settings.files.emplace_back(argument);
        }
        return;
    }
    std::string list;
    for (const std::string& argument : parsed.arguments) list += (list.empty() ? "" : ", ") + argument;
    throw UsageError(std::string(command.name) + ": expects " + std::string(command.arguments) + ", got " +
                     (found == 0 ? "nothing" : list) + "; see isowave " + std::string(command.name) +
                     " --help");
}

void takeOptions(const ParsedCommand& parsed, Settings& settings) {
    for (const auto& [option, found] : parsed.options) {
        if (found->count() == 0) continue;
        try {
            option->apply(settings, option->isFlag() ? std::string() : found->as<std::string>());
        } catch (const UsageError& error) {
            throw UsageError(std::string(option->longName()) + ": " + error.what());
        }
    }
}

Settings settingsOf(const ParsedCommand& parsed) {
    Settings settings;
    settings.help = parsed.help;
    if (parsed.help) return settings;
    takeOptions(parsed, settings);  // first: of "--iso -o out", -o is no number, and out is no argument too many
    takeArguments(parsed, settings);
    if (parsed.command->needsOutput && !settings.output)
        throw UsageError(std::string(parsed.command->name) + ": -o is missing; say where the result goes");
    return settings;
}

}  // namespace

Invocation parseCommandLine(int argc, const char* const* argv) {
    CLI::App app;
    app.set_help_flag();
    bool help = false, version = false;
    app.add_flag("-h,--help", help);
    app.add_flag("--version", version);
    app.require_subcommand(0, 1);
    std::vector<std::unique_ptr<ParsedCommand>> parsed;
    for (const Command& command : commands()) parsed.push_back(declare(app, command));

    try {
        app.parse(argc, argv);
    } catch (const CLI::ArgumentMismatch& error) {  // "--iso: At Most 1 required but received 2"
        const std::string text = oneLine(error.what());
        throw UsageError(text.substr(0, text.find(':')) +
                         ": expects one value, given once; see isowave --help");
    } catch (const CLI::ParseError& error) {
        throw UsageError(oneLine(error.what()) + "; see isowave --help");
    }

    Invocation invocation;
    for (const auto& candidate : parsed)
        if (candidate->app->parsed()) {
            invocation.command = candidate->command;
            invocation.settings = settingsOf(*candidate);
            return invocation;
        }
    invocation.version = version;
    invocation.settings.help = help;
    if (!help && !version) {
        std::string list;
        for (const Command& command : commands())
            list += (list.empty() ? "" : ", ") + std::string(command.name);
        throw UsageError("a subcommand is missing: " + list + "; see isowave --help");
    }
    return invocation;
}

}  // namespace isowave::tools
