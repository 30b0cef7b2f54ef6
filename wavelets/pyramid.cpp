#include "wavelets/pyramid.h"

#include <cassert>

namespace isowave::wavelets {
namespace {

constexpr std::int64_t kOneNode = 4 * 4 * 4;  // control points of a single node

// Every direction halves the domain until it has one node, so fields end at 64 control points. A guard
// against a field that for some reason stays larger: three directions in a row, twice, without one control
// point less.
constexpr int kStepsWithoutProgress = 6;

}  // namespace

Pyramid analyse(const BSplineField& field, const AnalyseOptions& options, const Progress& progress,
                const std::function<void(int, const BSplineField&)>& onStep) {
    Pyramid pyramid;
    pyramid.K = field.K;
    BSplineField current = field;
    const double whole = static_cast<double>(std::max<std::int64_t>(1, field.controlPointCount()));
    std::int64_t left = field.controlPointCount();
    double worked = 0;
    int withoutProgress = 0;
    if (onStep) onStep(0, current);
    while (left > kOneNode && pyramid.stepCount() < options.maxSteps &&
           withoutProgress < kStepsWithoutProgress) {
        progress("analysing", std::min(1.0, worked / (3 * whole)));
        const int axis = pyramid.stepCount() % 3;
        DirectionResult result = analyseDirection(current, axis, progress);
        pyramid.steps.push_back({axis, current.shape, result.details});
        current = std::move(result.coarse);
        worked += static_cast<double>(left);
        const std::int64_t now = current.controlPointCount();
        withoutProgress = now < left ? 0 : withoutProgress + 1;
        left = now;
        if (onStep) onStep(pyramid.stepCount(), current);
    }
    progress("analysing", 1);
    pyramid.coarsest = std::move(current);
    return pyramid;
}

BSplineField Pyramid::field(int step, const Progress& progress) const {
    assert(0 <= step && step <= stepCount());
    BSplineField current = coarsest;
    for (int s = stepCount() - 1; s >= step; --s) {
        const Step& fine = steps[static_cast<std::size_t>(s)];
        progress("synthesising", double(stepCount() - 1 - s) / std::max(1, stepCount() - step));
        current = synthesiseDirection(current, *fine.details, *fine.shape, fine.axis, progress);
    }
    progress("synthesising", 1);
    return current;
}

std::int64_t Pyramid::coefficientsStored() const {
    std::int64_t count = coarsest.controlPointCount();
    for (const Step& step : steps) count += static_cast<std::int64_t>(step.details->activeVoxelCount());
    return count;
}

}  // namespace isowave::wavelets
