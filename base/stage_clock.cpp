#include "base/stage_clock.h"

#include <algorithm>

namespace isowave {

StageClock::StageClock(const std::vector<StageSeconds>& before, double secondsBefore)
    : start_(std::chrono::steady_clock::now()), last_(start_), before_(secondsBefore), stages_(before) {}

std::size_t StageClock::indexOf(const std::string& stage) {
    auto found =
        std::find_if(stages_.begin(), stages_.end(), [&](const auto& s) { return s.stage == stage; });
    if (found == stages_.end()) found = stages_.insert(stages_.end(), {stage, 0.0});
    return static_cast<std::size_t>(found - stages_.begin());
}

void StageClock::charge(Time now) {
    if (!open_.empty()) stages_[open_.back()].seconds += std::chrono::duration<double>(now - last_).count();
    last_ = now;
}

StageClock::Scope::Scope(StageClock& clock, const std::string& stage) : clock_(clock) {
    clock.charge(std::chrono::steady_clock::now());
    clock.open_.push_back(clock.indexOf(stage));
}

StageClock::Scope::~Scope() {
    clock_.charge(std::chrono::steady_clock::now());
    clock_.open_.pop_back();
}

double StageClock::secondsSoFar() const {
    return before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

}  // namespace isowave
