#include "tools/stage_log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "base/number_text.h"
#include "base/peak_memory.h"

namespace isowave::tools {
namespace {

// Memory that the process holds now.
std::int64_t residentBytes() {
    std::int64_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * ::sysconf(_SC_PAGESIZE);
}

constexpr auto kLeastApart = std::chrono::milliseconds(20);  // of two looks at the memory within a stage

}  // namespace

StageLog::StageLog()
    : stages_{{"starting"}},
      begin_(std::chrono::steady_clock::now()),
      last_(begin_),
      peakBefore_(peakMemoryBytes()) {}

void StageLog::report(std::string_view stage) {
    const Time now = std::chrono::steady_clock::now();
    const bool same = stages_[current_].name == stage;
    if (same && now - last_ < kLeastApart) return;
    charge(now);
    if (same) return;
    auto found =
        std::find_if(stages_.begin(), stages_.end(), [&](const Stage& s) { return s.name == stage; });
    if (found == stages_.end()) found = stages_.insert(found, {std::string(stage)});
    current_ = static_cast<std::size_t>(found - stages_.begin());
}

// A peak that rose since the last look was reached by this stage.
void StageLog::charge(Time now) {
    Stage& stage = stages_[current_];
    stage.seconds += std::chrono::duration<double>(now - last_).count();
    last_ = now;
    const std::int64_t peak = peakMemoryBytes();
    stage.bytes = std::max(stage.bytes, peak > peakBefore_ ? peak : residentBytes());
    peakBefore_ = peak;
}

std::string StageLog::text() {
    charge(std::chrono::steady_clock::now());
    std::string text;
    const auto line = [&](std::string_view name, double seconds, std::int64_t bytes) {
        text +=
            fmt::format("  {:<22} {:>9.2f} s {:>10}\n", name, seconds, bytesText(static_cast<double>(bytes)));
    };
    for (const Stage& stage : stages_) line(stage.name, stage.seconds, stage.bytes);
    line("whole run", std::chrono::duration<double>(last_ - begin_).count(), peakBefore_);
    return text;
}

}  // namespace isowave::tools
