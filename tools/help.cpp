#include "tools/help.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace isowave::tools {
namespace {

constexpr std::size_t kWidth = 100;

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

// "-o, --output PATH"
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
    std::string line = fmt::format("isowave {} {}", command.name, command.arguments);
    if (command.needsOutput) line += " -o PATH";
    const bool hasOptions = std::any_of(options().begin(), options().end(),
                                        [&](const Option& option) { return option.belongsTo(command.name); });
    return hasOptions ? line + " [options]" : line;
}

std::string upperFirst(std::string_view text) {
    std::string result(text);
    if (!result.empty()) result[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(result[0])));
    return result;
}

// '|' separates the cells of a markdown table.
std::string cell(std::string text) {
    for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
    return text;
}

// "lod:-o|lod:--output|mesh:-o|...": the subcommand and the word before the one to complete. (--json takes a
// file in one subcommand and nothing in others, so the name alone would not do.)
std::string valuePattern(const Option& option) {
    std::string pattern;
    for (const Command& command : commands()) {
        if (!option.belongsTo(command.name)) continue;
        std::string_view rest = option.names;
        while (!rest.empty()) {
            const auto comma = std::min(rest.find(','), rest.size());
            pattern +=
                fmt::format("{}{}:{}", pattern.empty() ? "" : "|", command.name, rest.substr(0, comma));
            rest.remove_prefix(std::min(comma + 1, rest.size()));
        }
    }
    return pattern;
}

std::string valueReply(const Option& option) {
    if (option.takesFile()) return "COMPREPLY=($(compgen -f -- \"$word\")); return";
    if (!option.isChoice()) return "return";
    std::string words(option.metavar);
    std::replace(words.begin(), words.end(), '|', ' ');
    return fmt::format("COMPREPLY=($(compgen -W \"{}\" -- \"$word\")); return", words);
}

}  // namespace

std::string overview() {
    std::string text =
        "isowave: solids as B-spline zero sets, taken apart by wavelets; a closed mesh at every level.\n\n"
        "usage: isowave COMMAND ARGUMENTS [options]      isowave COMMAND --help      isowave --version\n\n";
    std::size_t longest = 0;
    for (const Command& command : commands()) longest = std::max(longest, command.name.size());
    for (const Command& command : commands())
        text += fmt::format("  {:<{}}  {}\n", command.name, longest, command.summary);
    text += "\nResults go to standard output, remarks and progress to standard error. Exit codes:\n";
    for (const ExitCode& exit : exitCodes()) text += fmt::format("  {:>3}  {}\n", exit.code, exit.meaning);
    return text;
}

std::string helpFor(const Command& command) {
    std::string text = fmt::format("usage: {}\n\n{}.\n", usage(command), upperFirst(command.summary));
    if (!command.details.empty()) text += wrapped(command.details, 0) + "\n";
    text += "\n";
    constexpr std::size_t kColumn = 26;
    for (const Option& option : options()) {
        if (!option.belongsTo(command.name)) continue;
        const std::string left = "  " + signature(option);
        text += left.size() + 2 > kColumn ? left + "\n" + std::string(kColumn, ' ')
                                          : left + std::string(kColumn - left.size(), ' ');
        text += wrapped(explained(option), kColumn) + "\n";
    }
    return text;
}

std::string markdownHelp() {
    std::string text;
    for (const Command& command : commands()) {
        text += fmt::format("### isowave {}\n\n{}.\n", command.name, upperFirst(command.summary));
        if (!command.details.empty()) text += wrapped(command.details, 0) + "\n";
        text += fmt::format("\n    {}\n\n", usage(command));
        bool first = true;
        for (const Option& option : options()) {
            if (!option.belongsTo(command.name)) continue;
            if (first) text += "| option | default | meaning |\n|---|---|---|\n";
            first = false;
            text += fmt::format("| `{}` | {} | {} |\n", cell(signature(option)),
                                cell(std::string(option.fallback)), cell(std::string(option.help)));
        }
        if (!first) text += "\n";
    }
    text += "### Exit codes\n\n| code | meaning |\n|---|---|\n";
    for (const ExitCode& exit : exitCodes()) text += fmt::format("| {} | {} |\n", exit.code, exit.meaning);
    return text;
}

std::string bashCompletion() {
    std::string names, offered, values;
    for (const Command& command : commands()) {
        names += (names.empty() ? "" : " ") + std::string(command.name);
        std::string list = "--help";
        for (const Option& option : options())
            if (option.belongsTo(command.name)) list += " " + std::string(option.longName());
        offered += fmt::format("        {}) offered=\"{}\" ;;\n", command.name, list);
    }
    for (const Option& option : options())
        if (!option.isFlag())
            values += fmt::format("        {}) {} ;;\n", valuePattern(option), valueReply(option));
    return fmt::format(R"(# bash completion for isowave; made by: isowave completion bash
_isowave() {{
    local word="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD-1]}}" command="${{COMP_WORDS[1]}}"
    local offered=""
    COMPREPLY=()
    if [ "$COMP_CWORD" -eq 1 ]; then
        COMPREPLY=($(compgen -W "{} --help --version" -- "$word"))
        return
    fi
    case "$command:$before" in
{}    esac
    case "$command" in
{}    esac
    case "$word" in
        -*) COMPREPLY=($(compgen -W "$offered" -- "$word")) ;;
        *) COMPREPLY=($(compgen -f -- "$word")) ;;
    esac
}}
complete -o filenames -F _isowave isowave
)",
                       names, values, offered);
}

}  // namespace isowave::tools
