#include "tools/cli.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "isowave/error.h"
#include "tools/similar.h"

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
        CLI::Option* const found =
            option.isFlag() ? parsed->app->add_flag(names) : parsed->app->add_option(names)->expected(1);
        if (option.repeats) found->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        parsed->options.emplace_back(&option, found);
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
    if (enough || (found == 0 && (expected.front() == '[' || command.hasOtherInputs()))) {
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

void applyValue(const Option& option, const std::string& value) {
    try {
        option.apply(value);
    } catch (const UsageError& error) {
        const bool isOption =
            value.starts_with("--") && value.size() > 2;  // of "--glb-lods --colour distance"
        throw UsageError(std::string(option.longName()) + ": " + error.what() +
                         (isOption ? fmt::format("; {} is an option, and the value {} is missing before it",
                                                 value, option.metavar)
                                   : std::string()));
    }
}

// Those that may be given several times come first, in the order in which they stand on the line, whatever they are.
void takeOptions(const ParsedCommand& parsed) {
    std::map<const CLI::Option*, std::size_t> taken;
    for (const CLI::Option* const next : parsed.app->parse_order())
        for (const auto& [option, found] : parsed.options)
            if (found == next && option->repeats) applyValue(*option, found->results().at(taken[found]++));
    for (const auto& [option, found] : parsed.options)
        if (found->count() > 0 && !option->repeats)
            applyValue(*option, option->isFlag() ? std::string() : found->as<std::string>());
}

// Options come first: of "--iso -o out", -o is no number, and out is no argument too many.
void take(const ParsedCommand& parsed) {
    takeOptions(parsed);
    takeArguments(parsed);
    if (parsed.command->needsOutput() && !parsed.command->hasOutput())
        throw UsageError(std::string(parsed.command->name()) + ": -o is missing; say where the result goes");
}

// The first word that looks like an option and is none of the command's.
std::string unknownOption(const Command& command, int argc, const char* const* argv) {
    const std::vector<std::string_view> known = command.options().names();
    for (int i = 2; i < argc; ++i) {
        const std::string_view word(argv[i]), name = word.substr(0, word.find('='));
        if (name.starts_with("--") && name.size() > 2 &&
            std::find(known.begin(), known.end(), name) == known.end())
            return std::string(name);
    }
    return {};
}

[[noreturn]] void refuseOption(const Command& command, const std::string& name) {
    const std::string help = fmt::format("isowave {} --help", command.name());
    throw UsageError(fmt::format("there is no option {} of {}{}", name, command.name(),
                                 suggestion(name, command.options().names(), help)));
}

// "-part.stl" is taken for options.
std::string fileWithDash(int argc, const char* const* argv) {
    std::error_code ignored;
    for (int i = 2; i < argc; ++i)
        if (argv[i][0] == '-' && std::filesystem::is_regular_file(argv[i], ignored))
            return fmt::format("; if it is a file, write ./{}", argv[i]);
    return {};
}

void parse(const Commands& commands, CLI::App& app, int argc, const char* const* argv) {
    const bool named = argc > 1 && argv[1][0] != '-';
    const std::string help =
        "; see isowave " + (named ? std::string(argv[1]) + " " : std::string()) + "--help";
    try {
        app.parse(argc, argv);
    } catch (const CLI::ArgumentMismatch& error) {  // "--iso: At Most 1 required but received 2"
        const std::string text = oneLine(error.what());
        throw UsageError(text.substr(0, text.find(':')) + ": expects one value, given once" + help);
    } catch (const CLI::ParseError& error) {
        const Command* command = named ? findCommand(commands, argv[1]) : nullptr;
        const std::string unknown = command ? unknownOption(*command, argc, argv) : std::string();
        if (!unknown.empty()) refuseOption(*command, unknown);
        throw UsageError(oneLine(error.what()) + fileWithDash(argc, argv) + help);
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
    std::vector<std::string_view> names;
    for (const auto& command : commands) names.push_back(command->name());
    const std::string_view meant = similarTo(argv[1], names);
    throw UsageError(fmt::format("there is no subcommand '{}'{}{}", argv[1],
                                 meant.empty() ? "; there are " + namesOf(commands) : "",
                                 suggestion(argv[1], names, "isowave --help")));
}

}  // namespace

Invocation parseCommandLine(const Commands& commands, int argc, const char* const* argv) {
    CLI::App app;
    app.set_help_flag();
    Invocation invocation;
    app.add_flag("-h,--help", invocation.help);
    app.add_flag("--version", invocation.version);
    app.add_flag("--verbose", invocation.verbose);
    app.require_subcommand(0, 1);
    std::vector<std::unique_ptr<ParsedCommand>> parsed;
    for (const auto& command : commands) parsed.push_back(declare(app, *command));
    refuseUnknownCommand(commands, argc, argv);
    parse(commands, app, argc, argv);
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
