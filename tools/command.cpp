#include "tools/command.h"

#include <algorithm>
#include <fstream>

#include "base/atomic_file.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/json.h"

namespace isowave::tools {
namespace {

std::filesystem::path placeOfReport(const std::string& text) {
    return text == "-" ? std::filesystem::path("-") : place(text);
}

}  // namespace

void OptionList::value(std::string_view names, std::string_view metavar, std::string_view fallback,
                       std::string_view help, std::function<void(const std::string&)> apply) {
    options_.push_back({names, metavar, fallback, help, std::move(apply)});
}

void OptionList::values(std::string_view names, std::string_view metavar, std::string_view help,
                        std::function<void(const std::string&)> apply) {
    options_.push_back({names, metavar, "", help, std::move(apply), /*repeats=*/true});
}

void OptionList::flag(std::string_view names, std::string_view help, bool& set) {
    options_.push_back({names, "", "", help, [&set](const std::string&) { set = true; }});
}

void OptionList::input(std::string_view names, std::string_view help,
                       std::optional<std::filesystem::path>& set) {
    options_.push_back({names, "FILE", "", help, [&set](const std::string& text) { set = place(text); }});
    inputs_.push_back(&set);
}

std::vector<std::string_view> OptionList::names() const {
    std::vector<std::string_view> names{"--help"};
    for (const Option& option : options_) names.push_back(option.longName());
    return names;
}

std::vector<std::filesystem::path> OptionList::inputs() const {
    std::vector<std::filesystem::path> given;
    for (const auto* input : inputs_)
        if (*input) given.push_back(**input);
    return given;
}

void OptionList::result(std::string_view names, std::string_view metavar, std::string_view help,
                        std::optional<std::filesystem::path>& set, PlaceOf placeOf) {
    options_.push_back(
        {names, metavar, "", help, [&set, placeOf](const std::string& text) { set = placeOf(text); }});
    results_.push_back(&set);
}

void OptionList::result(std::string_view names, std::string_view metavar, std::string_view help,
                        std::optional<std::filesystem::path>& set) {
    result(names, metavar, help, set, place);
}

std::vector<std::filesystem::path> OptionList::results() const {
    std::vector<std::filesystem::path> given;
    for (const auto* result : results_)
        if (*result && **result != "-") given.push_back(**result);
    return given;
}

int Command::argumentCount() const {
    return static_cast<int>(std::count(description_.arguments.begin(), description_.arguments.end(), ' ')) +
           1;
}

void Command::declareOutput(std::string_view help) { options_.result("-o,--output", "PATH", help, output_); }

void Command::declareJson() {
    options_.result("--json", "FILE",
                    "the report as JSON goes to this file; - is standard output, in place of the text", json_,
                    placeOfReport);
}

// `check --json a.ply b.ply` has taken a mesh for the name of the report.
void Command::refuseToReplaceWhatIsNoReport() const {
    std::error_code ignored;
    if (!jsonToFile() || !std::filesystem::is_regular_file(*json_, ignored)) return;
    std::string start;
    std::ifstream file(*json_);
    for (char c; start.size() < 10 && file.get(c);)
        if (c != ' ' && c != '\n') start += c;
    if (!start.empty() && start != "{\"version\"")
        throw UsageError("--json: takes the name of a file to write, and " + json_->string() +
                         " exists and is no report; choose another name, or - to print");
}

void Command::openJson() {
    if (!jsonToFile() || jsonFile_) return;
    jsonFolders_.emplace(*json_);
    jsonFile_.emplace(*json_);
}

void Command::readyToTell(Console& console, const std::string& json) {
    console.progress().check();
    openJson();
    report_ = withRemarks(json, console.remarks());
    if (jsonFile_) writeWhole(*jsonFile_, *report_);
}

void Command::tell(Console& console, const std::string& text, const std::string& json) {
    if (!report_) readyToTell(console, json);
    if (jsonFile_) {
        jsonFile_->commit();
        jsonFolders_->commit();
    }
    console.print(jsonToStandardOutput() ? *report_ : text);
}

void Command::declareThreads() {
    options_.value("--threads", "N", "all", "threads to use; the result does not depend on it, to the bit",
                   [this](const std::string& v) { threads = static_cast<int>(integer(v, 1, 4096)); });
}

void Command::declareTalk() {
    options_.value("--progress", "bar|plain|none", "bar on a terminal, otherwise none",
                   "a line that is redrawn; a line of its own for each stage, at most one a second; nothing",
                   [this](const std::string& v) {
                       talk.progress = choice<ProgressStyle>(v, {{"bar", ProgressStyle::bar},
                                                                 {"plain", ProgressStyle::plain},
                                                                 {"none", ProgressStyle::none}});
                   });
    options_.flag("--verbose", "at the end, seconds and memory by stage on standard error", talk.verbose);
    options_.flag("--quiet", "no progress and no remarks on standard error", talk.quiet);
}

}  // namespace isowave::tools
