#include "wavelets/pyramid.h"

#include <cassert>

#include "wavelets/exact.h"

namespace isowave::wavelets {
namespace {

constexpr std::int64_t kOneNode = 4 * 4 * 4;  // control points of a single node

// Halves direction after direction. onDirection(axis, shape, details): the shape of the finer field and what
// leads back to it.
template <class OnDirection>
BSplineField halveAll(BSplineField current, const AnalyseOptions& options, const Progress& progress,
                      const std::function<void(int, const BSplineField&)>& onStep,
                      const OnDirection& onDirection) {
    FieldExtent extent = FieldExtent::of(current);
    const double whole = static_cast<double>(std::max<std::int64_t>(1, extent.controlPoints));
    double worked = 0;
    Halved halved = options.from;
    if (onStep) onStep(halved.step, current);
    while (halved.step < options.maxSteps && goesOn(halved, extent)) {
        progress("analysing", std::min(1.0, worked / (3 * whole)));
        const int axis = options.order.axisAfter(halved.step);
        DirectionResult result = analyseDirection(current, axis, progress);
        onDirection(axis, std::move(current.shape), std::move(result.details));
        current = std::move(result.coarse);
        worked += static_cast<double>(extent.controlPoints);
        const FieldExtent now = FieldExtent::of(current);
        halved = halvedAlong(axis, halved, extent, now);
        extent = now;
        if (onStep) onStep(halved.step, current);
    }
    progress("analysing", 1);
    return current;
}

std::int64_t countOf(const DetailGrid& details) {
    return static_cast<std::int64_t>(details.activeVoxelCount());
}

}  // namespace

// Halving moves every known control point towards the lattice's origin until -1 .. 2 is left on each axis, so
// fields end at 64 control points; on the way the number of control points may stay for many steps while the
// domain moves on. A domain that straddles the origin stays at -2 .. 2 instead: then none of the three directions
// changes anything.
FieldExtent FieldExtent::of(const BSplineField& field) {
    return {field.controlPointCount(), field.controlPoints->evalActiveVoxelBoundingBox()};
}

void FieldExtent::add(const FieldExtent& part) {
    if (part.controlPoints == 0) return;
    controlPoints += part.controlPoints;
    box.expand(part.box);
}

bool goesOn(const Halved& halved, const FieldExtent& extent) {
    constexpr int kAll = 1 << 0 | 1 << 1 | 1 << 2;
    return extent.controlPoints > kOneNode && halved.unchanged != kAll;
}

Halved halvedAlong(int axis, Halved halved, const FieldExtent& from, const FieldExtent& to) {
    return {halved.step + 1, to == from ? halved.unchanged | 1 << axis : 0};
}

Pyramid analyse(const BSplineField& field, const AnalyseOptions& options, const Progress& progress,
                const std::function<void(int, const BSplineField&)>& onStep) {
    Pyramid pyramid;
    pyramid.K = field.K;
    pyramid.order = options.order;
    pyramid.coarsest =
        halveAll(field, options, progress, onStep, [&](int axis, Shape::Ptr shape, DetailGrid::Ptr details) {
            pyramid.steps.push_back({axis, std::move(shape), std::move(details)});
        });
    return pyramid;
}

Descent descend(BSplineField field, const AnalyseOptions& options, const Progress& progress,
                const std::function<void(int, const BSplineField&)>& onStep) {
    Descent descent;
    descent.steps = options.from.step;
    descent.coarsest =
        halveAll(std::move(field), options, progress, onStep, [&](int, Shape::Ptr, DetailGrid::Ptr details) {
            ++descent.steps;
            descent.coefficientsStored += countOf(*details);
        });
    descent.coefficientsStored += descent.coarsest.controlPointCount();
    return descent;
}

BSplineField Pyramid::field(int step, const Progress& progress) const {
    assert(0 <= step && step <= stepCount());
    BSplineField current = coarsest;
    for (int s = stepCount() - 1; s >= step; --s) {
        const Step& fine = steps[static_cast<std::size_t>(s)];
        progress("synthesising", double(stepCount() - 1 - s) / std::max(1, stepCount() - step));
        current = synthesiseDirection(current, *fine.details, *fine.shape, fine.axis, progress);
    }
    if (step == 0 && exact) restore(*exact, current);
    progress("synthesising", 1);
    return current;
}

std::int64_t Pyramid::coefficientsStored() const {
    std::int64_t count = coarsest.controlPointCount();
    for (const Step& step : steps) count += countOf(*step.details);
    return count;
}

}  // namespace isowave::wavelets
