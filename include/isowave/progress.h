// Progress, remarks and cancellation, passed into every long function; nothing here is global.
#pragma once

#include <exception>
#include <functional>
#include <string>
#include <string_view>

#include "isowave/version.h"

namespace isowave {

// Thrown out of a long function whose Progress asked it to stop. Results are returned by value and files are
// written under temporary names, so nothing half-done survives it.
class ISOWAVE_EXPORT Cancelled : public std::exception {
  public:
    const char* what() const noexcept override { return "cancelled"; }
};

// REQUIRES: report and stopRequested may be called from several threads at once; all three should return quickly.
// Copyable; a default-made one reports nowhere and never stops.
struct Progress {
    // stage: what is being done ("analysing"); done: 0..1 of that stage.
    std::function<void(std::string_view stage, double done)> report;
    std::function<bool()> stopRequested;
    // A decision, or a default that was taken, in one line: "part.stl: --voxels 256 along the longest axis". The library
    // itself never prints. Called by the thread that called the long function.
    std::function<void(std::string_view line)> remark = {};

    void operator()(std::string_view stage, double done) const {
        check();
        if (report) report(stage, done);
    }
    // Throws Cancelled when a stop was asked for.
    void check() const {
        if (stopRequested && stopRequested()) throw Cancelled();
    }
    void say(std::string_view line) const {
        if (remark) remark(line);
    }
};

// How long one stage of a long function took: {"polygonize", 0.42}.
struct StageSeconds {
    std::string stage;
    double seconds = 0;
};

}  // namespace isowave
