// Which steps are asked for, and which are looked at.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "isowave/ladder.h"

namespace isowave::lod {

class StepChoice {
  public:
    // budgets: every step is looked at, but levels are asked for only where the options say so. levelsLimit: levels before the
    // first that is asked for are looked at, as they are with LevelOptions::adaptive. Throws UsageError.
    StepChoice(const LevelOptions& options, bool budgets, bool levelsLimit, const StepOrder& order);

    // Whether the step's level is asked for.
    bool has(int step) const {
        return levels_ && step >= first_ && (!last_ || step <= *last_) && (steps_ || order_.levelOf(step));
    }
    // Whether the step is looked at, be it asked for or not.
    bool visits(int step) const {
        return all_ || step == 0 || has(step) || isKept(step) ||
               (allBefore_ && step < first_ && order_.levelOf(step));
    }
    // Whether a region of coarser levels keeps the step's level.
    bool isKept(int step) const { return std::find(kept_.begin(), kept_.end(), step) != kept_.end(); }
    // The coarsest of them; -1: there is none.
    int lastKept() const { return kept_.empty() ? -1 : kept_.back(); }
    int first() const { return first_; }
    std::optional<int> last() const { return last_; }
    std::optional<int> lastVisited() const { return all_ ? std::nullopt : last_; }

  private:
    bool levels_, all_, allBefore_;
    bool steps_;  // every step is asked for, not levels alone
    StepOrder order_;
    int first_ = 0;
    std::optional<int> last_;
    std::vector<int> kept_;
};

}  // namespace isowave::lod
