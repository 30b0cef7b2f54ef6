// The ways in which a function of isowave does not return what it promises, and the exit codes that the command makes
// of them.
//
//   caller bug     assert(): the caller broke a documented REQUIRES.
//   wrong options  UsageError: options contradict each other or do not suit the input.   exit code 2
//   bad data       InputError: what came from outside is not what it must be.            exit code 3
//   failed work    OperationError: the data was fine, the world was not (disk full).     exit code 1
// Stopped work (the user pressed Ctrl-C) is Cancelled in isowave/progress.h.              exit code 130
#pragma once

#include <stdexcept>
#include <string>

#include "isowave/version.h"

namespace isowave {

// What every message below goes through. Control characters, which a damaged file brings into a message that shows a piece of it,
// become '?': a message is one line and sends no commands to a terminal. What is longer than kLongestMessage bytes ends in "...".
inline constexpr std::size_t kLongestMessage = 4000;
inline std::string messageOf(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
    if (text.size() > kLongestMessage) text.replace(kLongestMessage, text.npos, "...");
    return text;
}

// Bad data. The message is one line that names the object, the place, what was found, what was expected and
// what to do:  skull.nrrd: 'sizes' says 512x512x300 (157 MB) but the file holds 94 MB; it is truncated
class ISOWAVE_EXPORT InputError : public std::runtime_error {
  public:
    explicit InputError(const std::string& line) : std::runtime_error(messageOf(line)) {}
    // object: the file, grid or mesh;  what: the rest of the line.
    InputError(const std::string& object, const std::string& what)
        : std::runtime_error(messageOf(object + ": " + what)) {}
};

// Options contradict each other, or ask for what this kind of input does not have. The message names them as the command
// spells them: "--voxel and --voxels exclude each other; give one of them".
class ISOWAVE_EXPORT UsageError : public std::runtime_error {
  public:
    explicit UsageError(const std::string& line) : std::runtime_error(messageOf(line)) {}
};

// The operation itself failed: a file could not be written, memory would not suffice.
class ISOWAVE_EXPORT OperationError : public std::runtime_error {
  public:
    explicit OperationError(const std::string& line) : std::runtime_error(messageOf(line)) {}
    OperationError(const std::string& object, const std::string& what)
        : std::runtime_error(messageOf(object + ": " + what)) {}
};

}  // namespace isowave
