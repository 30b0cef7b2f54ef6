#include "curves2d/pyramid.h"

#include <cassert>
#include <string>

namespace isowave::curves2d {
namespace {

constexpr std::int32_t kNodeSize = 4;  // control points of one node along an axis

template <class Real>
bool isOneNode(const RowField<Real>& field) {
    const Bounds box = field.bounds();
    return box.size(0) <= kNodeSize && box.size(1) <= kNodeSize;
}

}  // namespace

template <class Real>
RowField<Real> Pyramid<Real>::field(int step, const Progress& progress) const {
    assert(0 <= step && step <= stepCount());
    RowField<Real> field = coarsest;
    for (int s = stepCount() - 1; s >= step; --s) {
        const Step<Real>& taken = steps[static_cast<std::size_t>(s)];
        if (field.axis != taken.axis) field = transposed(field);
        field = synthesiseDirection(field, taken, progress);
    }
    return field;
}

template <class Real>
std::int64_t Pyramid<Real>::coefficientCount() const {
    std::int64_t count = coarsest.controlPointCount();
    for (const Step<Real>& step : steps) count += step.detailCount();
    return count;
}

template <class Real>
Pyramid<Real> analyse(RowField<Real> field, int mostSteps, const Progress& progress,
                      const StepVisitor<Real>& visit) {
    [[maybe_unused]] const Bounds box = field.bounds();
    assert(box.first[0] >= -1 && box.first[1] >= -1);
    Pyramid<Real> pyramid;
    if (field.axis != 0) field = transposed(field);
    if (visit) visit(0, field);
    for (int step = 0; step < mostSteps && !isOneNode(field); ++step) {
        progress.check();
        DirectionResult<Real> result = analyseDirection(field, progress);
        pyramid.steps.push_back(std::move(result.step));
        field = transposed(result.coarse);
        if (visit) visit(step + 1, field);
    }
    pyramid.coarsest = std::move(field);
    return pyramid;
}

std::string stepName(int step) { return "L" + std::to_string(step / 2) + (step % 2 ? "a" : ""); }

#define ISOWAVE_INSTANTIATE(Real)  \
    template struct Pyramid<Real>; \
    template Pyramid<Real> analyse(RowField<Real>, int, const Progress&, const StepVisitor<Real>&);
ISOWAVE_INSTANTIATE(float)
ISOWAVE_INSTANTIATE(double)
#undef ISOWAVE_INSTANTIATE

}  // namespace isowave::curves2d
