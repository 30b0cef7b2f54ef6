#include "tools/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace isowave::tools {
namespace {

constexpr std::size_t kWidth = 100;

constexpr ExitCode kExitCodes[] = {
    {0, "done"},
    {1, "the work failed: a file could not be written, memory did not suffice"},
    {2, "the command line is wrong"},
    {3, "the input is not what it must be; one line says what was found, what was expected and what to do"},
    {4, "check: the mesh is not closed, not 2-manifold or not oriented"},
    {130, "interrupted (Ctrl-C); nothing was left behind"},
};

// Words of text, broken before column kWidth; every line but the first starts at column `indent`.
std::string wrapped(std::string_view text, std::size_t indent) {
    std::istringstream words{std::string(text)};
    std::string result, word;
    std::size_t column = indent;
    while (words >> word) {
        if (column + word.size() + 1 > kWidth && column > indent) {
            result += "\n" + std::string(indent, ' ');
            column = indent;
        }
        if (column > indent) result += ' ', ++column;
        result += word;
        column += word.size();
    }
    return result;
}

// '|' separates the cells of a markdown table.
std::string cell(std::string text) {
    for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
    return text;
}

// | option | default | meaning |, one row an option.
std::string markdownOptions(const Command& command) {
    if (command.options().all().empty()) return {};
    std::string text = "| option | default | meaning |\n|---|---|---|\n";
    for (const Option& option : command.options().all())
        text += fmt::format("| `{}` | {} | {} |\n", cell(signature(option)),
                            cell(std::string(option.fallback)), cell(std::string(option.help)));
    return text + "\n";
}

}  // namespace

std::span<const ExitCode> exitCodes() { return kExitCodes; }

std::string signature(const Option& option) {
    std::string names(option.names);
    if (const auto comma = names.find(','); comma != std::string::npos) names.insert(comma + 1, " ");
    return option.isFlag() ? names : names + " " + std::string(option.metavar);
}

std::string explained(const Option& option) {
    std::string text(option.help);
    if (!option.fallback.empty()) text += " (default: " + std::string(option.fallback) + ")";
    return text;
}

std::string usage(const Command& command) {
    std::string line = fmt::format("isowave {} {}", command.name(), command.description().arguments);
    if (command.needsOutput()) line += " -o PATH";
    return command.options().all().empty() ? line : line + " [options]";
}

std::string upperFirst(std::string_view text) {
    std::string result(text);
    if (!result.empty()) result[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(result[0])));
    return result;
}

std::string overview(const Commands& commands) {
    std::string text =
        "isowave: solids as B-spline zero sets, taken apart by wavelets; a closed mesh at every level.\n\n"
        "usage: isowave COMMAND ARGUMENTS [options]      isowave COMMAND --help      isowave --version\n\n";
    std::size_t longest = 0;
    for (const auto& command : commands) longest = std::max(longest, command->name().size());
    for (const auto& command : commands)
        text += fmt::format("  {:<{}}  {}\n", command->name(), longest, command->description().summary);
    text += "\nResults go to standard output, remarks and progress to standard error. Exit codes:\n";
    for (const ExitCode& exit : kExitCodes) text += fmt::format("  {:>3}  {}\n", exit.code, exit.meaning);
    return text;
}

std::string helpFor(const Command& command) {
    const Command::Description& about = command.description();
    std::string text = fmt::format("usage: {}\n\n{}.\n", usage(command), upperFirst(about.summary));
    if (!about.details.empty()) text += wrapped(about.details, 0) + "\n";
    text += "\n";
    constexpr std::size_t kColumn = 26;
    for (const Option& option : command.options().all()) {
        const std::string left = "  " + signature(option);
        text += left.size() + 2 > kColumn ? left + "\n" + std::string(kColumn, ' ')
                                          : left + std::string(kColumn - left.size(), ' ');
        text += wrapped(explained(option), kColumn) + "\n";
    }
    return text;
}

std::string markdownHelp(const Commands& commands) {
    std::string text;
    for (const auto& command : commands) {
        const Command::Description& about = command->description();
        text += fmt::format("### isowave {}\n\n{}.\n", about.name, upperFirst(about.summary));
        if (!about.details.empty()) text += wrapped(about.details, 0) + "\n";
        text += fmt::format("\n    {}\n\n", usage(*command)) + markdownOptions(*command);
    }
    text += "### Exit codes\n\n| code | meaning |\n|---|---|\n";
    for (const ExitCode& exit : kExitCodes) text += fmt::format("| {} | {} |\n", exit.code, exit.meaning);
    return text;
}

}  // namespace isowave::tools
