#include "lod/step_choice.h"

#include "isowave/error.h"

namespace isowave {

void checkRanges(const LevelOptions& options) {
    if (options.levels && options.steps)
        throw UsageError("--levels and --steps exclude each other; level L is step 3L");
}

namespace lod {

StepChoice::StepChoice(const LevelOptions& options, bool budgets)
    : levels_(!budgets || options.levels || options.steps),
      all_(budgets),
      stride_(options.steps ? 1 : kStepsPerLevel) {
    checkRanges(options);
    const StepRange range = options.steps ? *options.steps : options.levels.value_or(StepRange{});
    first_ = range.first * stride_;
    if (range.last) last_ = *range.last * stride_;
}

}  // namespace lod
}  // namespace isowave
