#include "wavelets/pyramid.h"

#include <cassert>

namespace isowave::wavelets {
namespace {

constexpr std::int64_t kOneNode = 4 * 4 * 4;  // control points of a single node

// Halving moves every known control point towards the lattice's origin until -1 .. 2 is left on each axis, so fields end
// at 64 control points; on the way the number of control points may stay for many steps while the domain moves on. A
// domain that straddles the origin stays at -2 .. 2 instead: then three directions in a row change nothing.
struct Extent {
    std::int64_t controlPoints;
    openvdb::CoordBBox box;

    explicit Extent(const BSplineField& field)
        : controlPoints(field.controlPointCount()), box(field.controlPoints->evalActiveVoxelBoundingBox()) {}
    bool operator==(const Extent&) const = default;
};

}  // namespace

Pyramid analyse(const BSplineField& field, const AnalyseOptions& options, const Progress& progress,
                const std::function<void(int, const BSplineField&)>& onStep) {
    Pyramid pyramid;
    pyramid.K = field.K;
    BSplineField current = field;
    const double whole = static_cast<double>(std::max<std::int64_t>(1, field.controlPointCount()));
    Extent extent(field);
    double worked = 0;
    int unchanged = 0;
    if (onStep) onStep(0, current);
    while (extent.controlPoints > kOneNode && pyramid.stepCount() < options.maxSteps && unchanged < 3) {
        progress("analysing", std::min(1.0, worked / (3 * whole)));
        const int axis = pyramid.stepCount() % 3;
        DirectionResult result = analyseDirection(current, axis, progress);
        pyramid.steps.push_back({axis, current.shape, result.details});
        current = std::move(result.coarse);
        worked += static_cast<double>(extent.controlPoints);
        const Extent now(current);
        unchanged = now == extent ? unchanged + 1 : 0;
        extent = now;
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
