#include "tools/shell/man_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "isowave/version.h"
#include "tools/help.h"

namespace isowave::tools {
namespace {

// A line of its own of troff: backslashes and hyphens as they are, and no request of ours where it begins with '.' or '\''.
std::string troff(std::string_view text) {
    std::string result;
    if (!text.empty() && (text.front() == '.' || text.front() == '\'')) result = "\\&";
    for (const char c : text) {
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else if (c == '\n')
            result += ' ';
        else
            result += c;
    }
    return result;
}

std::string upper(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return text;
}

std::string head(const std::string& page, std::string_view summary) {
    return fmt::format(".TH {} 1 \"\" \"isowave {}\" \"isowave\"\n.SH NAME\n{} \\- {}\n", upper(troff(page)),
                       ISOWAVE_VERSION, troff(page), troff(summary));
}

std::string section(std::string_view title, const std::string& text) {
    return text.empty() ? std::string() : fmt::format(".SH {}\n{}\n", title, text);
}

std::string optionEntries(const Command& command) {
    std::string text;
    for (const Option& option : command.options().all())
        text +=
            fmt::format(".TP\n.B {}\n{}\n", troff(signature(option)), troff(upperFirst(explained(option))));
    return text.substr(0, text.empty() ? 0 : text.size() - 1);
}

std::string exitEntries() {
    std::string text;
    for (const ExitCode& exit : exitCodes())
        text += fmt::format("{}.TP\n.B {}\n{}", text.empty() ? "" : "\n", exit.code, troff(exit.meaning));
    return text;
}

std::string pageOf(const Command& command) {
    const Command::Description& about = command.description();
    return head("isowave-" + std::string(about.name), about.summary) +
           section("SYNOPSIS", ".B " + troff(usage(command))) +
           section("DESCRIPTION", troff(upperFirst(about.summary)) + ".\n" + troff(about.details)) +
           section("OPTIONS", optionEntries(command)) + section("EXIT STATUS", exitEntries()) +
           section("SEE ALSO", ".BR isowave (1)");
}

std::string overviewPage(const Commands& commands) {
    std::string entries;
    for (const auto& command : commands)
        entries += fmt::format("{}.TP\n.BR isowave\\-{} (1)\n{}", entries.empty() ? "" : "\n",
                               troff(command->name()), troff(command->description().summary));
    return head("isowave", "solids at many levels of detail, a closed mesh each") +
           section("SYNOPSIS",
                   ".B isowave\nCOMMAND ARGUMENTS [options]\n.br\n.B isowave \\-\\-version [\\-\\-verbose]") +
           section("DESCRIPTION",
                   "Describes a solid by a B\\-spline function, takes it apart by wavelets, and makes a "
                   "closed mesh at "
                   "every level. Results go to standard output, remarks and progress to standard error.") +
           section("COMMANDS", entries) + section("EXIT STATUS", exitEntries());
}

}  // namespace

std::map<std::string, std::string> manPages(const Commands& commands) {
    std::map<std::string, std::string> pages{{"isowave.1", overviewPage(commands)}};
    for (const auto& command : commands)
        pages[fmt::format("isowave-{}.1", command->name())] = pageOf(*command);
    return pages;
}

}  // namespace isowave::tools
