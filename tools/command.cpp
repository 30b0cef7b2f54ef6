#include "tools/command.h"

#include <algorithm>

#include "base/atomic_file.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"

namespace isowave::tools {

void OptionList::value(std::string_view names, std::string_view metavar, std::string_view fallback,
                       std::string_view help, std::function<void(const std::string&)> apply) {
    options_.push_back({names, metavar, fallback, help, std::move(apply)});
}

void OptionList::flag(std::string_view names, std::string_view help, bool& set) {
    options_.push_back({names, "", "", help, [&set](const std::string&) { set = true; }});
}

void OptionList::result(std::string_view names, std::string_view metavar, std::string_view help,
                        std::optional<std::filesystem::path>& set) {
    options_.push_back({names, metavar, "", help, [&set](const std::string& text) { set = place(text); }});
    results_.push_back(&set);
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
                    "the report as JSON goes to this file; - is standard output, in place of the text",
                    json_);
}

void Command::openJson() {
    if (!jsonToFile() || jsonFile_) return;
    jsonFolders_.emplace(*json_);
    jsonFile_.emplace(*json_);
}

void Command::tell(Console& console, const std::string& text, const std::string& json) {
    console.progress().check();
    openJson();
    if (jsonFile_) {
        writeWhole(*jsonFile_, json);
        jsonFile_->commit();
        jsonFolders_->commit();
    }
    console.print(jsonToStandardOutput() ? json : text);
}

void Command::declareThreads() {
    options_.value("--threads", "N", "all", "threads to use; the result does not depend on it, to the bit",
                   [this](const std::string& v) { threads = static_cast<int>(integer(v, 1, 4096)); });
}

void Command::declareQuiet() {
    options_.flag("--quiet", "no progress and no remarks on standard error", quiet);
}

}  // namespace isowave::tools
