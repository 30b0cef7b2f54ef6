// Seconds and memory by stage, as stages report themselves: what --verbose tells.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace isowave::tools {

class StageLog {
  public:
    StageLog();
    // A report of the stage at work: the first one of another stage ends the one before.
    void report(std::string_view stage);
    // One line a stage, in the order of their beginnings, and one for the whole. Times before the first report go to "starting";
    // memory is the most that the process held while the stage was at work.
    std::string text();

  private:
    using Time = std::chrono::steady_clock::time_point;
    struct Stage {
        std::string name;
        double seconds = 0;
        std::int64_t bytes = 0;
    };
    void charge(Time now);

    std::vector<Stage> stages_;
    std::size_t current_ = 0;
    Time begin_, last_;
    std::int64_t peakBefore_ = 0;  // of the process, when the last report came
};

}  // namespace isowave::tools
