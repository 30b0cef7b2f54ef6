// Seconds by stage, in the order in which stages are first named.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "isowave/progress.h"

namespace isowave {

class StageClock {
  public:
    // before: what earlier work of the same job took; it counts as if it had been done just now.
    explicit StageClock(const std::vector<StageSeconds>& before = {}, double secondsBefore = 0);

    // Time from construction to destruction goes to a stage; a nested one stops the outer one's clock, so the
    // sum of all stages never exceeds the total.
    class Scope {
      public:
        Scope(StageClock& clock, const std::string& stage);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

      private:
        StageClock& clock_;
    };

    // Gives a stage its place in the list before it begins.
    void announce(const std::string& stage) { indexOf(stage); }
    double secondsSoFar() const;
    const std::vector<StageSeconds>& stages() const { return stages_; }

  private:
    using Time = std::chrono::steady_clock::time_point;
    std::size_t indexOf(const std::string& stage);
    void charge(Time now);  // to the innermost stage

    Time start_, last_;
    double before_;
    std::vector<StageSeconds> stages_;
    std::vector<std::size_t> open_;  // indices into stages_, outermost first
};

}  // namespace isowave
