// What a fuzz target is, and what all of them ask of what they call.
//
// A target is a function of the bytes of one file. libFuzzer calls it with mutated bytes (fuzzer.cpp), and every build
// calls it with the seeds and the regression files (replay.cpp). What counts as a finding:
//   - a sanitizer's report, a signal, an assertion
//   - an exception that isowave/error.h does not promise; a message that is not one line, or that does not name the file
//   - a broken require(): values that are not finite, indices beyond the points, a round trip that changes something
//   - more than 1 GB in one allocation, 2 GB in all, 20 s (libFuzzer's limits, scripts/fuzz)
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/error.h"

namespace isowave::fuzz {

enum class Answer { read, refused };

struct Target {
    std::string name;  // and of its folders: seeds/NAME (scripts/fuzz), regressions/NAME
    std::function<Answer(std::string_view bytes)> run;
};

// Prints `what` and aborts unless it holds.
void require(bool holds, const char* what);

// One line of printable text; lastMessage() is what it was called with last.
void requireOneLine(const std::string& message);
const std::string& lastMessage();
// It names the object, or a file beside it in the scratch folder.
void requireNamed(const std::string& message, const std::string& object);

// What became of `work` on `object`, the name of a file or of something in memory, which bad data is reported of. An
// exception that is not promised goes on to libFuzzer.
template <class Work>
Answer answerOf(const std::string& object, const Work& work) {
    try {
        work();
        return Answer::read;
    } catch (const InputError& e) {
        requireOneLine(e.what());
        requireNamed(e.what(), object);
    } catch (const UsageError& e) {
        requireOneLine(e.what());
    } catch (const OperationError& e) {
        requireOneLine(e.what());
    }
    return Answer::refused;
}

// A folder of this process in memory (/dev/shm where there is one), removed when it ends. `voxels.raw`, 4 kB, lies in it for
// headers that name a file beside them.
const std::filesystem::path& scratchFolder();

// Writes the bytes to a file of this name there and returns its path.
std::filesystem::path fileOf(std::string_view bytes, const std::string& name);

// The targets of this program, one of a name each.
std::vector<Target> targets();

}  // namespace isowave::fuzz
