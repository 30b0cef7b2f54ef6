#include "tools/shell/completion.h"

#include <fmt/format.h>

#include <algorithm>

namespace isowave::tools {
namespace {

// "lod:-o|lod:--output": the subcommand and the word before the one to complete.
std::string valuePattern(const Command& command, const Option& option) {
    std::string pattern;
    std::string_view rest = option.names;
    while (!rest.empty()) {
        const auto comma = std::min(rest.find(','), rest.size());
        pattern += fmt::format("{}{}:{}", pattern.empty() ? "" : "|", command.name(), rest.substr(0, comma));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
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

// Within '...' and before a ':' of _arguments.
std::string zshQuoted(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '\'') {
            result += "'\\''";
            continue;
        }
        if (c == ':' || c == '[' || c == ']' || c == '\\') result += '\\';
        result += c;
    }
    return result;
}

std::string zshAction(const Option& option) {
    if (option.takesFile()) return "_files";
    if (!option.isChoice()) return " ";
    std::string words(option.metavar);
    std::replace(words.begin(), words.end(), '|', ' ');
    return "(" + words + ")";
}

// '(-o --output)'{-o,--output}'[the folder ...]:PATH:_files'
std::string zshOption(const Option& option) {
    std::string spaced(option.names);
    std::replace(spaced.begin(), spaced.end(), ',', ' ');
    const bool several = option.names.find(',') != option.names.npos;
    const std::string names =
        several ? fmt::format("'({})'{{{}}}'", spaced, option.names) : fmt::format("'{}", option.names);
    const std::string value =
        option.isFlag() ? ""
                        : fmt::format(":{}:{}", zshQuoted(option.isChoice() ? "choice" : option.metavar),
                                      zshAction(option));
    return fmt::format("                {}[{}]{}' \\\n", names, zshQuoted(option.help), value);
}

// What the arguments are, where they are no files.
std::string zshArguments(const Command& command, const std::string& names) {
    if (command.name() == "completion") return "'1:shell:(bash zsh)'";
    if (command.name() == "help") return fmt::format("'1:command:({})'", names);
    return "'*:file:_files'";
}

std::string namesOf(const Commands& commands) {
    std::string names;
    for (const auto& command : commands) names += (names.empty() ? "" : " ") + std::string(command->name());
    return names;
}

}  // namespace

std::string bashCompletion(const Commands& commands) {
    const std::string names = namesOf(commands);
    std::string offered, values;
    for (const auto& command : commands) {
        std::string list = "--help";
        for (const Option& option : command->options().all()) {
            list += " " + std::string(option.longName());
            if (!option.isFlag())
                values +=
                    fmt::format("        {}) {} ;;\n", valuePattern(*command, option), valueReply(option));
        }
        offered += fmt::format("        {}) offered=\"{}\" ;;\n", command->name(), list);
    }
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

std::string zshCompletion(const Commands& commands) {
    const std::string names = namesOf(commands);
    std::string described, cases;
    for (const auto& command : commands) {
        described +=
            fmt::format("        '{}:{}'\n", command->name(), zshQuoted(command->description().summary));
        std::string options;
        for (const Option& option : command->options().all()) options += zshOption(option);
        cases += fmt::format(
            "        {})\n            _arguments \\\n{}                '--help[this command]' {}\n           "
            " ;;\n",
            command->name(), options, zshArguments(*command, names));
    }
    return fmt::format(R"(#compdef isowave
# zsh completion for isowave; made by: isowave completion zsh
_isowave() {{
    local -a commands
    commands=(
{}    )
    if (( CURRENT == 2 )); then
        _describe 'command' commands
        compadd -- --help --version
        return
    fi
    shift words
    (( CURRENT-- ))
    case "$words[1]" in
{}    esac
}}
if [ "$funcstack[1]" = "_isowave" ]; then
    _isowave "$@"
else
    compdef _isowave isowave
fi
)",
                       described, cases);
}

}  // namespace isowave::tools
