#include "wavelets/pyramid.h"

#include <cassert>

#include "wavelets/exact.h"

namespace isowave::wavelets {
namespace {

constexpr std::int64_t kOneNode = 4 * 4 * 4;  // control points of a single node

// Halving moves every known control point towards the lattice's origin until -1 .. 2 is left on each axis, so
// fields end at 64 control points; on the way the number of control points may stay for many steps while the
// domain moves on. A domain that straddles the origin stays at -2 .. 2 instead: then none of the three directions
// changes anything.
struct Extent {
    std::int64_t controlPoints;
    openvdb::CoordBBox box;

    explicit Extent(const BSplineField& field)
        : controlPoints(field.controlPointCount()), box(field.controlPoints->evalActiveVoxelBoundingBox()) {}
    bool operator==(const Extent&) const = default;
};

// Halves direction after direction. onDirection(axis, shape, details): the shape of the finer field and what
// leads back to it.
template <class OnDirection>
BSplineField halveAll(BSplineField current, const AnalyseOptions& options, const Progress& progress,
                      const std::function<void(int, const BSplineField&)>& onStep,
                      const OnDirection& onDirection) {
    Extent extent(current);
    const double whole = static_cast<double>(std::max<std::int64_t>(1, extent.controlPoints));
    double worked = 0;
    constexpr int kNone = 0, kAll = 1 << 0 | 1 << 1 | 1 << 2;
    int step = 0, unchanged = kNone;  // a bit for each axis that changed nothing since something last changed
    if (onStep) onStep(0, current);
    while (extent.controlPoints > kOneNode && step < options.maxSteps && unchanged != kAll) {
        progress("analysing", std::min(1.0, worked / (3 * whole)));
        const int axis = options.order.axisAfter(step++);
        DirectionResult result = analyseDirection(current, axis, progress);
        onDirection(axis, std::move(current.shape), std::move(result.details));
        current = std::move(result.coarse);
        worked += static_cast<double>(extent.controlPoints);
        const Extent now(current);
        unchanged = now == extent ? unchanged | 1 << axis : kNone;
        extent = now;
        if (onStep) onStep(step, current);
    }
    progress("analysing", 1);
    return current;
}

std::int64_t countOf(const DetailGrid& details) {
    return static_cast<std::int64_t>(details.activeVoxelCount());
}

}  // namespace

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
