// The one table of subcommands and options. The parser (cli.cpp), `--help`, the markdown of
// docs/interfaces.md and the shell completion (help.cpp) are all made from it: an option that is not in the
// table does not exist.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "tools/settings.h"

namespace isowave::tools {

class Console;

struct Option {
    std::string_view names;     // "--iso" or "-o,--output"
    std::string_view metavar;   // what follows it: "V", "FILE", "stl|ply|obj" (a choice); empty = a flag
    std::string_view fallback;  // what holds without it, in words; empty = nothing to say
    std::string_view help;
    std::string_view commands;  // the subcommands that take it, separated by single spaces
    // Puts the value (empty for a flag) into the settings. Throws UsageError, without naming the option.
    void (*apply)(Settings&, const std::string& value);

    bool isFlag() const { return metavar.empty(); }
    bool isChoice() const { return metavar.find('|') != metavar.npos; }
    bool takesFile() const { return metavar == "FILE" || metavar == "PATH"; }
    bool belongsTo(std::string_view command) const;
    std::string_view longName() const;  // "--output"
};

struct Command {
    std::string_view name;
    std::string_view arguments;  // "INPUT", "A B": one positional argument a word
    std::string_view summary;    // one line
    std::string_view details;    // a paragraph for --help
    bool needsOutput;            // -o is required
    int (*run)(const Settings&, Console&);

    int argumentCount() const;
};

struct ExitCode {
    int code;
    std::string_view meaning;
};

std::span<const Command> commands();
std::span<const Option> options();
std::span<const ExitCode> exitCodes();

// nullptr when there is none.
const Command* findCommand(std::string_view name);

// The subcommands, one file each (cmd_*.cpp). They return an exit code of the table; bad data, failed work
// and stopped work are thrown (isowave/error.h, isowave/progress.h).
int runLod(const Settings&, Console&);
int runAnalyse(const Settings&, Console&);
int runMesh(const Settings&, Console&);
int runField(const Settings&, Console&);
int runInfo(const Settings&, Console&);
int runCheck(const Settings&, Console&);
int runCompare(const Settings&, Console&);
int runFilters(const Settings&, Console&);
int runCurveLevels(const Settings&, Console&);
int runRelief(const Settings&, Console&);
int runReverse(const Settings&, Console&);
int runRebuild(const Settings&, Console&);
int runSubdivide(const Settings&, Console&);
int runCurves(const Settings&, Console&);
int runHelp(const Settings&, Console&);
int runCompletion(const Settings&, Console&);

}  // namespace isowave::tools
