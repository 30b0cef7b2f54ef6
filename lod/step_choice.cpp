#include "lod/step_choice.h"

#include "isowave/error.h"
#include "lod/option_checks.h"
#include "lod/regions/fine_regions.h"

namespace isowave {
namespace {

void requireSteps(const char* option, const std::optional<StepRange>& range) {
    if (!range) return;
    lod::requireAtLeast(option, range->first, 0);
    if (range->last && *range->last < range->first)
        throw UsageError(fmt::format("{}: {}..{} ends before it begins", option, range->first, *range->last));
}

}  // namespace

void checkRanges(const LevelOptions& options) {
    if (options.levels && options.steps)
        throw UsageError("--levels and --steps exclude each other; give one of them");
    requireSteps("--levels", options.levels);
    requireSteps("--steps", options.steps);
    lod::checkRegions(options);
}

namespace lod {

StepChoice::StepChoice(const LevelOptions& options, bool budgets, bool levelsLimit, const StepOrder& order)
    : levels_(!budgets || options.levels || options.steps),
      all_(budgets),
      allBefore_(levelsLimit || options.adaptive),
      steps_(options.steps.has_value()),
      order_(order) {
    checkRanges(options);
    const StepRange range = options.steps ? *options.steps : options.levels.value_or(StepRange{});
    const auto stepOf = [&](int number) { return steps_ ? number : order.stepOf(number); };
    first_ = stepOf(range.first);
    if (range.last) last_ = stepOf(*range.last);
    kept_ = stepsOf(options.fine, order);
}

}  // namespace lod
}  // namespace isowave
