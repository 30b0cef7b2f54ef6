// A subcommand of `isowave`: what it is called, which options it takes, what it does. It declares its own options, into
// variables of its own; parser (cli.h), `--help`, the markdown of docs/interfaces.md and the shell completion (help.h) are all
// made from that declaration, so an option that no command declares does not exist.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "tools/output.h"
#include "tools/talk.h"

namespace isowave::tools {

class Console;

struct Option {
    std::string_view names;     // "--iso" or "-o,--output"
    std::string_view metavar;   // what follows it: "V", "FILE", "stl|ply|obj" (a choice); empty: a flag
    std::string_view fallback;  // what holds without it, in words; empty: nothing to say
    std::string_view help;
    // Takes the value (empty for a flag). Throws UsageError without naming the option.
    std::function<void(const std::string& value)> apply;
    bool repeats = false;  // may be given several times: each value is taken, in their order

    bool isFlag() const { return metavar.empty(); }
    bool isChoice() const { return metavar.find('|') != metavar.npos; }
    bool takesFile() const { return metavar == "FILE" || metavar == "PATH"; }
    std::string_view longName() const { return names.substr(names.find("--")); }
};

// Ways to declare an option; `help` and `fallback` must outlive the program's parsing (literals do).
class OptionList {
  public:
    void value(std::string_view names, std::string_view metavar, std::string_view fallback,
               std::string_view help, std::function<void(const std::string&)> apply);
    // One that may be given several times.
    void values(std::string_view names, std::string_view metavar, std::string_view help,
                std::function<void(const std::string&)> apply);
    void flag(std::string_view names, std::string_view help, bool& set);
    // A file that the command reads; main() sees to it that no result takes its place.
    void input(std::string_view names, std::string_view help, std::optional<std::filesystem::path>& set);
    // A file or folder that the command writes; main() sees to it that no input and no other result has its place.
    using PlaceOf = std::filesystem::path (*)(const std::string& text);
    void result(std::string_view names, std::string_view metavar, std::string_view help,
                std::optional<std::filesystem::path>& set, PlaceOf placeOf);
    void result(std::string_view names, std::string_view metavar, std::string_view help,
                std::optional<std::filesystem::path>& set);

    const std::vector<Option>& all() const { return options_; }
    // "--output", "--iso", ...: the long ones, --help with them.
    std::vector<std::string_view> names() const;
    // The inputs whose options were given.
    std::vector<std::filesystem::path> inputs() const;
    // The results whose options were given.
    std::vector<std::filesystem::path> results() const;

  private:
    std::vector<Option> options_;
    std::vector<const std::optional<std::filesystem::path>*> inputs_, results_;
};

class Command {
  public:
    struct Description {
        std::string_view name;
        std::string_view
            arguments;  // "INPUT", "A B", "[SUBDIVISION]", "INPUT..." (one or more): one positional argument a word
        std::string_view summary;  // one line
        std::string_view details;  // a paragraph for --help
    };

    explicit Command(const Description& description) : description_(description) {}
    virtual ~Command() = default;
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

    const Description& description() const { return description_; }
    std::string_view name() const { return description_.name; }
    const OptionList& options() const { return options_; }
    int argumentCount() const;
    // "INPUT...": or more than that.
    bool takesMore() const { return description_.arguments.ends_with("..."); }
    // An existing file that does not begin as reports do, {"version", is not replaced by --json. Throws UsageError.
    void refuseToReplaceWhatIsNoReport() const;
    // Whether the arguments may be left out, because an option has taken their place.
    virtual bool hasOtherInputs() const { return false; }
    // Whether -o must be given.
    virtual bool needsOutput() const { return false; }
    bool hasOutput() const { return output_.has_value(); }

    // Does the work with the arguments and options that the parser has put in. Returns an exit code of the table in
    // help.h; bad data, failed work, stopped work and contradicting options are thrown (isowave/error.h, progress.h).
    virtual int run(Console& console) = 0;

    std::vector<std::filesystem::path> arguments;  // the positional ones, in order
    int threads = 0;                               // 0: all
    Talk talk;

  private:
    Description description_;
    std::optional<OutputFile> jsonFolders_;
    std::optional<AtomicFile> jsonFile_;
    std::optional<std::string> report_;  // as it is told, once it is ready

  protected:
    OptionList options_;
    std::optional<std::filesystem::path> output_;
    std::optional<std::filesystem::path> json_;  // "-": standard output

    // The options that several commands share, in the words that fit each.
    void declareOutput(std::string_view help);
    void declareJson();
    void declareThreads();
    // --quiet, --verbose, --progress.
    void declareTalk();
    bool jsonToStandardOutput() const { return json_ && *json_ == "-"; }
    bool jsonToFile() const { return json_ && *json_ != "-"; }
    // Finds out at once whether the file of --json can be written, before there are other results. Throws OperationError.
    void openJson();
    // For commands that have other results: call it before the first of them takes its place. All that may still stop the
    // command, a wish or a disk without room for --json's file, stops it here; tell() then only renames and prints. Throws
    // Cancelled, OperationError.
    void readyToTell(Console& console, const std::string& json);
    // What the command has to tell: `text` to standard output and, with --json, `json` to its file or, for -, in place of the
    // text. Does what readyToTell() does where nobody has called it.
    void tell(Console& console, const std::string& text, const std::string& json);
};

}  // namespace isowave::tools
