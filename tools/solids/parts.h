// Several inputs in one go, `isowave lod A.stl B.stl -o DIR`: each is a job of its own, whose results are those of a run of
// its own to the byte. A job that fails leaves nothing and does not stop the others.
//
// The jobs run one after another, each with all threads: memory is that of the largest one.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "isowave/progress.h"
#include "tools/command.h"
#include "tools/report/json.h"

namespace isowave::tools {

// Which inputs there are: the arguments, and those of --list.
struct PartsChoice {
    std::optional<std::filesystem::path> list;  // "-": standard input

    void declare(OptionList& options);
    // More than one argument, or a list, however long it is.
    bool asksForParts(const std::vector<std::filesystem::path>& arguments) const;
    // The arguments, then the list. Throws InputError when the list cannot be read, UsageError when there is nothing in it.
    std::vector<std::filesystem::path> inputs(const std::vector<std::filesystem::path>& arguments) const;
};

struct Part {
    std::filesystem::path input;
    std::filesystem::path output;  // the folder or file of its results
};

// What an input's results are called: its own name without .gz and without the extension; of a folder all of it.
std::string partName(const std::filesystem::path& input);

// Inputs -> DIR/NAME + extension each. Throws UsageError when two would have one place, and when one would take the place of
// an input or have one in its folder.
std::vector<Part> partsOf(const std::vector<std::filesystem::path>& inputs,
                          const std::filesystem::path& folder, const std::string& extension = {});

// Throws UsageError when `place`, a file that is written beside the parts' results, is an input or lies among the results of
// one.
void refuseAmong(const std::vector<Part>& parts, const std::filesystem::path& place);

inline constexpr int kInterrupted = 130;  // exit code

// What a job that succeeded has to tell.
struct PartStory {
    std::string text;            // "5 levels, 12,000 to 96 triangles"
    Json json = Json::object();  // further keys of its entry
};

// Runs the jobs; a line on standard output for each that is done (unless `silent`), one on standard error for each that
// failed.
class PartsRun {
  public:
    using Work = std::function<PartStory(const Part& part, const Progress& progress)>;

    PartsRun(std::vector<Part> parts, Console& console) : parts_(std::move(parts)), console_(console) {}

    // Returns the exit code: 0 when all are done; 1, 3 or 2 when any has failed by it, the first of these that occurs; 130 when
    // interrupted: what was done before stays.
    int run(const Work& work, bool silent);
    // "198 of 200 parts are done, 2 failed; 12.3 s"
    std::string text() const;
    // {"version": 1, "parts": [{"input", "output", "exit_code", "error", "seconds", "remarks", ...}], "done", "failed", ...}
    Json json() const;

  private:
    struct Outcome {
        PartStory story;
        int exitCode = 0;
        std::string error;
        std::vector<std::string> remarks;
        double seconds = 0;
    };
    Outcome outcomeOf(const Part& part, const Work& work);
    void tell(const Part& part, const Outcome& outcome, bool silent);
    int exitCode() const;
    std::size_t failed() const;

    std::vector<Part> parts_;
    Console& console_;
    std::vector<Outcome> outcomes_;
    double seconds_ = 0;
};

}  // namespace isowave::tools
