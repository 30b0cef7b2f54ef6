#include "tools/steps.h"

#include <fmt/format.h>

#include "isowave/error.h"

namespace isowave::tools {
namespace {

InputError tooFar(const std::string& name, int step, int count) {
    return InputError(name, fmt::format("has steps 0 to {} (levels 0 to {}), not step {}", count,
                                        count / kStepsPerLevel, step));
}

}  // namespace

BSplineField fieldAtStep(Solid solid, int step, const std::string& name, Console& console,
                         StageClock& clock) {
    if (solid.pyramid) {
        const StageClock::Scope scope(clock, "synthesise");
        if (step > solid.pyramid->stepCount()) throw tooFar(name, step, solid.pyramid->stepCount());
        return solid.pyramid->field(step, console.progress());
    }
    if (step == 0) return *std::move(solid.field);
    const StageClock::Scope scope(clock, "analyse");
    wavelets::Pyramid pyramid = wavelets::analyse(*solid.field, {.maxSteps = step}, console.progress());
    if (step > pyramid.stepCount()) throw tooFar(name, step, pyramid.stepCount());
    return std::move(pyramid.coarsest);
}

int wantedStep(const Settings& settings) {
    if (settings.step && settings.level)
        throw UsageError("--step and --level exclude each other; level L is step 3L");
    return settings.level ? kStepsPerLevel * *settings.level : settings.step.value_or(0);
}

std::vector<StepFacts> factsOf(const wavelets::Pyramid& pyramid) {
    std::vector<StepFacts> facts(pyramid.steps.size() + 1);
    openvdb::Vec3d spacing = pyramid.coarsest.transform().voxelSize();
    std::int64_t coefficients = 0;
    for (int step = pyramid.stepCount(); step >= 0; --step) {
        const bool last = step == pyramid.stepCount();
        const Shape& shape = last ? *pyramid.coarsest.shape : *pyramid.steps[step].shape;
        StepFacts& f = facts[step];
        f.step = step;
        if (!last) spacing[pyramid.steps[step].axis] /= 2;
        f.spacing = spacing;
        const auto box = shape.evalActiveVoxelBoundingBox();
        f.domain =
            box.empty() ? openvdb::Coord(0) : box.dim() - openvdb::Coord(3);  // m + 3 control points: m nodes
        f.controlPoints = static_cast<std::int64_t>(shape.activeVoxelCount());
        // definedNodeCount() looks at what is known, not at the values.
        BSplineField known;
        known.controlPoints = openvdb::FloatGrid::create(
            std::make_shared<openvdb::FloatTree>(shape.tree(), 0.0f, openvdb::TopologyCopy()));
        known.shape =
            std::const_pointer_cast<Shape>(last ? pyramid.coarsest.shape : pyramid.steps[step].shape);
        f.definedNodes = definedNodeCount(known);
        f.details = last ? 0 : static_cast<std::int64_t>(pyramid.steps[step].details->activeVoxelCount());
        coefficients += last ? f.controlPoints : f.details;
        f.coefficients = coefficients;
        f.leafOccupancy = leafOccupancyOf(shape);
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
    for (const wavelets::Step& step : pyramid.steps)
        bytes += static_cast<std::int64_t>(step.shape->memUsage() + step.details->memUsage());
    return bytes;
}

std::int64_t finestControlPoints(const wavelets::Pyramid& pyramid) {
    const Shape& shape = pyramid.steps.empty() ? *pyramid.coarsest.shape : *pyramid.steps.front().shape;
    return static_cast<std::int64_t>(shape.activeVoxelCount());
}

}  // namespace isowave::tools
