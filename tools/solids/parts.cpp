#include "tools/solids/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <map>

#include "base/number_text.h"
#include "isowave/error.h"
#include "tools/console.h"
#include "tools/failure.h"
#include "tools/option_values.h"

namespace isowave::tools {
namespace fs = std::filesystem;
namespace {

std::vector<fs::path> linesOf(std::istream& in, const std::string& name) {
    std::vector<fs::path> paths;
    for (std::string line; std::getline(in, line);) {
        if (line.find('\0') != std::string::npos)
            throw InputError(name, "is no text; --list takes a text file, one path a line");
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (!line.empty()) paths.emplace_back(line);
    }
    return paths;
}

std::vector<fs::path> listed(const fs::path& list) {
    if (list == "-") return linesOf(std::cin, "-");
    std::ifstream file(list);
    std::error_code ignored;
    if (!file || fs::is_directory(list, ignored))
        throw InputError(list.string(), "cannot be read; --list takes a text file, one path a line");
    return linesOf(file, list.string());
}

// The same for all names of one file or folder, be it there or not.
std::string keyOf(const fs::path& path) {
    std::error_code ignored;
    const fs::path absolute = fs::absolute(path).lexically_normal();
    return fs::weakly_canonical(absolute.has_filename() ? absolute : absolute.parent_path(), ignored)
        .string();
}

void refuseOneName(const Part& a, const Part& b) {
    throw UsageError(
        fmt::format("{} and {} would both go to {}; rename one of them, or run them with another -o each",
                    a.input.string(), b.input.string(), b.output.string()));
}

// An input must not lie where another one's results go; its own job looks after its own.
void refuseInputsAmong(const std::map<std::string, const Part*>& outputs, const std::vector<Part>& parts) {
    for (const Part& part : parts) {
        const fs::path key = keyOf(part.input);
        for (fs::path at = key; at != at.parent_path(); at = at.parent_path()) {
            const auto found = outputs.find(at.string());
            if (found == outputs.end() || (found->second == &part && at != key)) continue;
            throw UsageError(fmt::format("{} is an input, and {} gets results; choose another -o",
                                         part.input.string(), found->second->output.string()));
        }
    }
}

}  // namespace

void PartsChoice::declare(OptionList& options) {
    options.value(
        "--list", "FILE", "",
        "a text file with more inputs, one path a line; - is standard input. Each input gets results "
        "of its own below -o, even a single one",
        [this](const std::string& v) { list = v == "-" ? fs::path(v) : place(v); });
}

bool PartsChoice::asksForParts(const std::vector<fs::path>& arguments) const {
    return list || arguments.size() > 1;
}

std::vector<fs::path> PartsChoice::inputs(const std::vector<fs::path>& arguments) const {
    std::vector<fs::path> all = arguments;
    if (!list) return all;
    const std::vector<fs::path> more = listed(*list);
    all.insert(all.end(), more.begin(), more.end());
    if (all.empty()) throw UsageError(fmt::format("--list: {} names no input", list->string()));
    return all;
}

std::string partName(const fs::path& input) {
    const fs::path tidy = fs::absolute(input).lexically_normal();
    const fs::path path = tidy.has_filename() ? tidy : tidy.parent_path();
    if (fs::is_directory(path)) return path.filename().string();
    const fs::path plain = path.extension() == ".gz" ? path.stem() : path.filename();
    return plain.stem().string();
}

std::vector<Part> partsOf(const std::vector<fs::path>& inputs, const fs::path& folder,
                          const std::string& extension) {
    std::vector<Part> parts;
    for (const fs::path& input : inputs) parts.push_back({input, folder / (partName(input) + extension)});
    std::map<std::string, const Part*> outputs;
    for (const Part& part : parts) {
        const auto [other, isNew] = outputs.emplace(keyOf(part.output), &part);
        if (!isNew) refuseOneName(*other->second, part);
    }
    refuseInputsAmong(outputs, parts);
    return parts;
}

void refuseAmong(const std::vector<Part>& parts, const fs::path& place) {
    const fs::path key = keyOf(place);
    for (const Part& part : parts) {
        if (keyOf(part.input) == key)
            throw UsageError(place.string() +
                             " is what this command reads; choose another name for the result");
        const std::string output = keyOf(part.output);
        if (output == key || output == key.parent_path())
            throw UsageError(fmt::format("{} lies where {} gets its results; choose another place for it",
                                         place.string(), part.input.string()));
    }
}

int PartsRun::run(const Work& work, bool silent) {
    const auto begin = std::chrono::steady_clock::now();
    for (const Part& part : parts_) {
        console_.startPart(outcomes_.size(), parts_.size());
        Outcome outcome = outcomeOf(part, work);
        if (outcome.exitCode == kInterrupted) {
            console_.complain(
                fmt::format("interrupted; {} of {} parts were done before and stay, nothing else "
                            "was left behind",
                            outcomes_.size() - failed(), parts_.size()));
            return kInterrupted;
        }
        tell(part, outcome, silent);
        outcomes_.push_back(std::move(outcome));
    }
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return exitCode();
}

PartsRun::Outcome PartsRun::outcomeOf(const Part& part, const Work& work) {
    Outcome outcome;
    Progress progress = console_.progress();
    progress.remark = [&](std::string_view line) { outcome.remarks.emplace_back(line); };
    const auto begin = std::chrono::steady_clock::now();
    try {
        progress.check();
        outcome.story = work(part, progress);
    } catch (...) {
        const Failure failure = failureOf(std::current_exception());
        outcome = {.story = {}, .exitCode = failure.exitCode, .error = failure.message, .remarks = {}};
    }
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return outcome;
}

// Messages of bad data name their file already, others need not.
void PartsRun::tell(const Part& part, const Outcome& outcome, bool silent) {
    const std::string name = part.input.string();
    const auto named = [&](const std::string& line) {
        return line.find(name) == line.npos ? fmt::format("{}: {}", name, line) : line;
    };
    for (const std::string& remark : outcome.remarks) console_.say(named(remark));
    if (outcome.exitCode != 0)
        console_.complain(named(outcome.error));
    else if (!silent)
        console_.print(
            fmt::format("{}: {}, {:.2f} s\n", part.output.string(), outcome.story.text, outcome.seconds));
}

std::size_t PartsRun::failed() const {
    return static_cast<std::size_t>(std::count_if(
        outcomes_.begin(), outcomes_.end(), [](const Outcome& outcome) { return outcome.exitCode != 0; }));
}

int PartsRun::exitCode() const {
    for (const int code : {1, 3, 2})
        for (const Outcome& outcome : outcomes_)
            if (outcome.exitCode == code) return code;
    return 0;
}

std::string PartsRun::text() const {
    const auto count = static_cast<std::int64_t>(parts_.size());
    const auto bad = static_cast<std::int64_t>(failed());
    return fmt::format("{} of {} done, {} failed; {:.1f} s\n", grouped(count - bad), counted(count, "part"),
                       grouped(bad), seconds_);
}

Json PartsRun::json() const {
    Json entries = Json::array();
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
        const Outcome& outcome = outcomes_[i];
        Json entry{{"input", parts_[i].input.string()}, {"output", parts_[i].output.string()}};
        entry["exit_code"] = outcome.exitCode;
        entry["error"] = outcome.exitCode == 0 ? Json() : Json(outcome.error);
        entry["seconds"] = outcome.seconds;
        entry["remarks"] = outcome.remarks;
        entry.update(outcome.story.json);
        entries.push_back(std::move(entry));
    }
    const std::size_t bad = failed();
    return {{"version", 1},
            {"parts", std::move(entries)},
            {"done", parts_.size() - bad},
            {"failed", bad},
            {"seconds", seconds_}};
}

}  // namespace isowave::tools
