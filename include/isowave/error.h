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

#include "isowave/version.h"

namespace isowave {

// Bad data. The message is one line that names the object, the place, what was found, what was expected and
// what to do:  skull.nrrd: 'sizes' says 512x512x300 (157 MB) but the file holds 94 MB; it is truncated
class ISOWAVE_EXPORT InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
    // object: the file, grid or mesh;  what: the rest of the line.
    InputError(const std::string& object, const std::string& what)
        : std::runtime_error(object + ": " + what) {}
};

// Options contradict each other, or ask for what this kind of input does not have. The message names them as the command
// spells them: "--voxel and --voxels exclude each other; give one of them".
class ISOWAVE_EXPORT UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// The operation itself failed: a file could not be written, memory would not suffice.
class ISOWAVE_EXPORT OperationError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
    OperationError(const std::string& object, const std::string& what)
        : std::runtime_error(object + ": " + what) {}
};

}  // namespace isowave
