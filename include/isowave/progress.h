// Progress and cancellation, passed into every long function; nothing here is global.
#pragma once

#include <exception>
#include <functional>
#include <string_view>

namespace isowave {

// Thrown out of a long function whose Progress asked it to stop. Results are returned by value and files are
// written under temporary names, so nothing half-done survives it.
class Cancelled : public std::exception {
  public:
    const char* what() const noexcept override { return "cancelled"; }
};

// REQUIRES: both callbacks may be called from several threads at once; they should return quickly.
// Copyable; a default-made one reports nowhere and never stops.
struct Progress {
    // stage: what is being done ("analysing"); done: 0..1 of that stage.
    std::function<void(std::string_view stage, double done)> report;
    std::function<bool()> stopRequested;

    void operator()(std::string_view stage, double done) const {
        check();
        if (report) report(stage, done);
    }
    // Throws Cancelled when a stop was asked for.
    void check() const {
        if (stopRequested && stopRequested()) throw Cancelled();
    }
};

}  // namespace isowave
