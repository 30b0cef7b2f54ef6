#include "lod/fit_solid.h"

#include <fmt/format.h>

#include <cmath>

#include "base/number_text.h"
#include "isowave/error.h"
#include "lod/memory.h"
#include "lod/option_checks.h"
#include "lod/source.h"
#include "volume/distance.h"

namespace isowave::lod {
FitSummary summaryOf(const Fitting& fitting, const FitReport& report) {
    FitSummary summary;
    summary.method = fitting.method;
    if (fitting.method == FitMethod::distance) {
        summary.halfWidth = fitting.distance.halfWidth;
        summary.band = fitting.distance.band;
    }
    summary.filterPasses = report.filterPasses;
    summary.gradientPasses = report.gradientPasses;
    summary.latticePoints = report.latticePoints;
    summary.disagreeing = report.disagreeing;
    summary.repairPasses = report.repairPasses;
    summary.repaired = report.repaired;
    summary.repairFloor = report.repairFloor;
    summary.repairAgreed = report.repairAgreed;
    return summary;
}

const char* nameOf(FitMethod method) { return kFitMethods[static_cast<std::size_t>(method)]; }

Fitting fittingOf(const SolidOptions& options, FitMethod fallback) {
    Fitting fitting;
    fitting.method = options.fit.value_or(fallback);
    fitting.distance.halfWidth = options.halfWidth.value_or(fitting.distance.halfWidth);
    fitting.distance.band = options.band.value_or(fitting.distance.band);
    return fitting;
}

// Voxels. At 60 the distances of a mask of 24^3 voxels take 14 s, at 4 none.
constexpr double kWidest = 64;

void checkFitOptions(const SolidOptions& options) {
    requirePositive("--half-width", options.halfWidth);
    requirePositive("--band", options.band);
    requirePositive("--max-memory", options.maxMemory);
    requirePositive("--slab-memory", options.slabMemory);
    const DistanceFitOptions defaults;
    const double halfWidth = options.halfWidth.value_or(defaults.halfWidth),
                 band = options.band.value_or(defaults.band);
    if (halfWidth > kWidest)
        throw UsageError(
            fmt::format("--half-width {} is more than {} voxels; the field is known near the surface "
                        "alone, and what farther distances cost grows with their cube",
                        halfWidth, kWidest));
    if (band > halfWidth)
        throw UsageError(
            fmt::format("--band {} is wider than --half-width {}; the distance is known only within "
                        "the half-width",
                        band, halfWidth));
}

void fit(Solid::State& solid, const Fitting& fitting, const Samples& samples, double memoryLimit,
         const std::string& remedy, const Progress& progress, StageClock& clock) {
    FitReport report;
    std::optional<WallSummary> walls;
    const auto allow = [&](double bytesEach, auto count) {
        refuseTooLarge(solid.name(), bytesFor(samples.fieldOnly, bytesEach * static_cast<double>(count)),
                       memoryLimit, remedy);
    };
    if (fitting.method != FitMethod::distance) {
        const NodeCollection nodes = [&] {
            const StageClock::Scope scope(clock, "nodes");
            return samples.nodes();
        }();
        allow(kBytesPerNode, nodes.nodeCount());
        const StageClock::Scope scope(clock, "fit");
        solid.field = fitting.method == FitMethod::binary
                          ? fitBinary(nodes, fitting.binary, &report, progress)
                          : fitMask(nodes, fitting.mask, &report, progress);
    } else {
        openvdb::FloatGrid::Ptr grid = [&] {
            const StageClock::Scope scope(clock, "distance");
            return samples.distance();
        }();
        allow(samples.bytesPerBandPoint, grid->activeVoxelCount());
        const StageClock::Scope scope(clock, "fit");
        DistanceFitOptions options = fitting.distance;
        if (samples.walls) {
            options.adjust = [&](BSplineField& field, const openvdb::Coord& shift) {
                walls = samples.walls(field, *grid, shift);
            };
            solid.field = fitDistance(*grid, options, &report, progress);
        } else {
            solid.field = fitDistance(std::move(grid), options, &report, progress);
        }
    }
    solid.fit = summaryOf(fitting, report);
    solid.fit->walls = walls;
    tellDisagreement(report, progress);
}

void tellDisagreement(const FitReport& report, const Progress& progress) {
    if (report.disagreeing > 0)
        progress.say(fmt::format("the sign of {} of {} lattice points differs from the input's",
                                 grouped(report.disagreeing), grouped(report.latticePoints)));
}

NodeCollection nodesOfDistance(const openvdb::FloatGrid& distance) {
    auto inside = openvdb::BoolGrid::create(false);
    inside->setTransform(distance.transform().copy());
    auto& tree = inside->tree();
    for (auto value = distance.cbeginValueAll(); value; ++value) {
        if (*value >= 0) continue;
        if (value.isVoxelValue())
            tree.setValueOff(value.getCoord(), true);
        else
            tree.addTile(value.getLevel(), value.getCoord(), true, false);
    }
    return nodesFromSigns(*inside);
}

double volumeOfVoxel(const openvdb::math::Transform& transform) {
    return std::abs(transform.baseMap()->getAffineMap()->getMat4().getMat3().det());
}

double volumeInside(const Shape& shape) {
    return static_cast<double>(pointsInside(shape)) * volumeOfVoxel(shape.transform());
}

bool hasSurface(const BSplineField& field) {
    bool inside = false, outside = false;
    for (auto value = field.shape->cbeginValueOn(); value && !(inside && outside); ++value)
        (*value ? inside : outside) = true;
    return inside && outside;
}

void requireSurface(const BSplineField& field, const std::string& name, const std::string& remedy) {
    if (!hasSurface(field)) refuseNoSurface(name, remedy);
}

void refuseNoSurface(const std::string& name, const std::string& remedy) {
    throw InputError(name, "has no surface at this resolution: " + remedy);
}

}  // namespace isowave::lod
