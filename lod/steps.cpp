#include "lod/steps.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "isowave/error.h"

namespace isowave::lod {
namespace {

// The field of a step, as far as its shape tells.
BSplineField knownOf(const Shape::Ptr& shape) {
    BSplineField known;
    known.controlPoints = openvdb::FloatGrid::create(
        std::make_shared<openvdb::FloatTree>(shape->tree(), 0.0f, openvdb::TopologyCopy()));
    known.shape = shape;
    return known;
}

std::array<std::int64_t, 3> domainOf(const Shape& shape) {
    const auto box = shape.evalActiveVoxelBoundingBox();
    if (box.empty()) return {};
    const openvdb::Coord nodes = box.dim() - openvdb::Coord(3);  // m + 3 control points: m nodes
    return {nodes.x(), nodes.y(), nodes.z()};
}

// "x and y"; "xy, xy, x" where levels differ.
std::string firstAxesText(const StepOrder& order) {
    const std::vector<std::string>& levels = order.first;
    if (std::adjacent_find(levels.begin(), levels.end(), std::not_equal_to<>()) != levels.end())
        return fmt::format("{}", fmt::join(levels, ", "));
    std::string text;
    for (const char axis : levels.front()) text += (text.empty() ? "" : " and ") + std::string(1, axis);
    return text;
}

}  // namespace

StepOrder orderFor(const std::array<double, 3>& spacing, const SolidOptions& options, const std::string& name,
                   const Progress& progress) {
    if (options.axes == StepAxes::xyz) return {};
    const StepOrder order =
        options.axes == StepAxes::cubes ? StepOrder::forVoxels(spacing, 1) : StepOrder::forVoxels(spacing);
    if (!order.first.empty())
        progress.say(fmt::format(
            "{}: voxels are {:.4g} x {:.4g} x {:.4g}: the first {} {} only, later ones x, y and z (--axes "
            "xyz: "
            "all of them)",
            name, spacing[0], spacing[1], spacing[2],
            order.first.size() == 1 ? "level halves" : fmt::format("{} levels halve", order.first.size()),
            firstAxesText(order)));
    return order;
}

std::string tooFarText(int step, int count, const StepOrder& order) {
    const std::optional<int> level = order.levelOf(step);
    return fmt::format("has steps 0 to {} (levels 0 to {}), not step {}{}", count, order.levelUpTo(count),
                       step, level ? fmt::format(" (level {})", *level) : "");
}

BSplineField fieldOf(const wavelets::Pyramid& pyramid, int step, const std::string& name,
                     const Progress& progress) {
    if (step < 0 || step > pyramid.stepCount())
        throw InputError(name, tooFarText(step, pyramid.stepCount(), pyramid.order));
    for (int s = step; s < pyramid.stepCount(); ++s)
        if (!pyramid.steps[static_cast<std::size_t>(s)].details)
            throw UsageError(
                fmt::format("{}: was opened from step {} on, and step {} is needed: holding thin parts "
                            "measures against step 0; open it "
                            "without finestStep, or ask for Holding::none",
                            name, s + 1, step));
    return pyramid.field(step, progress);
}

wavelets::Descent descendFrom(Solid solid, const wavelets::AnalyseOptions& options,
                              const std::function<bool(int step)>& isAskedFor,
                              const std::function<void(int step, const BSplineField&)>& onStep,
                              const Progress& progress) {
    const auto asked = [&](int step) { return isAskedFor && isAskedFor(step); };
    if (const auto slabs = SolidAccess::of(solid).slabs)
        return slabs->descend(options, asked, onStep, progress);
    return wavelets::descend(SolidAccess::takeField(std::move(solid)), options, progress, onStep);
}

BSplineField fieldAtStep(Solid solid, int step, const Progress& progress, StageClock& clock) {
    const std::string name = solid.input().path;
    if (const auto& pyramid = SolidAccess::of(solid).pyramid) {
        const StageClock::Scope scope(clock, "synthesise");
        return fieldOf(*pyramid, step, name, progress);
    }
    if (step == 0) return SolidAccess::takeField(std::move(solid));
    const StageClock::Scope scope(clock, "analyse");
    const StepOrder order = solid.order();
    const wavelets::Descent descent =
        descendFrom(std::move(solid), {.order = order, .maxSteps = step}, {}, {}, progress);
    if (step > descent.steps) throw InputError(name, tooFarText(step, descent.steps, order));
    return descent.coarsest;
}

std::vector<StepFacts> factsOf(const wavelets::Pyramid& pyramid) {
    std::vector<StepFacts> facts(pyramid.steps.size() + 1);
    openvdb::Vec3d spacing = pyramid.coarsest.transform().voxelSize();
    std::int64_t coefficients = 0;
    for (int step = pyramid.stepCount(); step >= 0; --step) {
        const bool last = step == pyramid.stepCount();
        const Shape::Ptr shape = last ? pyramid.coarsest.shape : pyramid.steps[step].shape;
        StepFacts& f = facts[step];
        f.step = step;
        f.level = pyramid.order.levelOf(step);
        if (step > 0) f.halvedAxis = pyramid.steps[step - 1].axis;
        if (!last) spacing[pyramid.steps[step].axis] /= 2;
        f.spacing = {spacing.x(), spacing.y(), spacing.z()};
        f.domain = domainOf(*shape);
        f.controlPoints = static_cast<std::int64_t>(shape->activeVoxelCount());
        f.nodes = definedNodeCount(knownOf(shape));  // looks at what is known, not at the values
        f.details = last ? 0 : static_cast<std::int64_t>(pyramid.steps[step].details->activeVoxelCount());
        coefficients += last ? f.controlPoints : f.details;
        f.coefficients = coefficients;
        f.leafOccupancy = leafOccupancyOf(*shape);
    }
    return facts;
}

double leafOccupancyOf(const Shape& shape) {
    constexpr double kLeafVoxels = openvdb::BoolTree::LeafNodeType::SIZE;
    const double held = kLeafVoxels * static_cast<double>(shape.tree().leafCount());
    return held > 0 ? static_cast<double>(shape.activeVoxelCount()) / held : 0;
}

std::int64_t bytesOf(const BSplineField& field) {
    return static_cast<std::int64_t>(field.controlPoints->memUsage() + field.shape->memUsage());
}

std::int64_t bytesOf(const wavelets::Pyramid& pyramid) {
    std::int64_t bytes = bytesOf(pyramid.coarsest);
    if (pyramid.exact) bytes += static_cast<std::int64_t>(pyramid.exact->memUsage());
    for (const wavelets::Step& step : pyramid.steps)
        bytes += static_cast<std::int64_t>(step.shape->memUsage() + step.details->memUsage());
    return bytes;
}

std::int64_t finestControlPoints(const wavelets::Pyramid& pyramid) {
    const Shape& shape = pyramid.steps.empty() ? *pyramid.coarsest.shape : *pyramid.steps.front().shape;
    return static_cast<std::int64_t>(shape.activeVoxelCount());
}

}  // namespace isowave::lod
