#include "lod/packing/pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/stage_clock.h"
#include "isowave/error.h"
#include "lod/memory.h"
#include "lod/source.h"
#include "lod/steps.h"
#include "lod/voxel_edges.h"
#include "polygonize/polygonize.h"
#include "wavelets/step_order.h"

namespace isowave {
namespace {

constexpr const char* kFirstLevels = "levels.first";  // among the source's texts
constexpr int kMostTries = 40;                        // of a smaller bound
constexpr double kLeastShrinking = 0.9;               // of the bound from one try to the next, at least
constexpr double kMostShrinking = 0.5;

void requirePositive(const std::optional<Length>& length, const char* option) {
    if (length && !(length->value > 0 && std::isfinite(length->value)))
        throw UsageError(
            fmt::format("{} is {}; give a length above 0, or leave it out", option, length->value));
}

// How vertices of one mesh moved to those of another.
struct Moved {
    bool sameTriangles = false;
    double largest = 0, rms = 0;
};

Moved movedBetween(const TriangleMesh& before, const TriangleMesh& after) {
    Moved moved;
    moved.sameTriangles = before.triangles == after.triangles && before.points.size() == after.points.size();
    if (!moved.sameTriangles) return moved;
    double squares = 0;
    for (std::size_t i = 0; i < before.points.size(); ++i) {
        const Point &a = before.points[i], &b = after.points[i];
        const double d = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        moved.largest = std::max(moved.largest, d);
        squares += d * d;
    }
    moved.rms = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, before.points.size())));
    return moved;
}

// Packs within a bound, and again within a smaller one until the mesh of level 0 is as it has to be.
class BoundedPacking {
  public:
    BoundedPacking(const BSplineField& field, const std::string& name, const PackOptions& options,
                   const Progress& progress)
        : field_(field), name_(name), progress_(progress), mesh_(polygonize(field, {}, progress)) {
        if (options.maxDistance) {
            const Length& d = *options.maxDistance;
            maxDistance_ =
                d.unit == Length::Unit::world ? d.value : d.value * lod::shortestVoxel(field.transform());
        }
        const Length first = options.bound.value_or(options.maxDistance.value_or(Length{}));
        bound_ = first.unit == Length::Unit::voxels ? first.value
                                                    : first.value / lod::longestVoxel(field.transform());
    }

    compress::PackedBytes run(compress::PackOptions options, PackReport& report) {
        if (const double most = options.voxelsPerK; bound_ > most)
            throw UsageError(
                fmt::format("{} is {:.4g} voxels; at most {:.4g}voxel is possible, the distance up "
                            "to which the field is known",
                            maxDistance_ ? "--max-distance" : "--bound", bound_, most));
        for (int tries = 0; tries < kMostTries; ++tries) {
            options.bound = bound_;
            options.source["packed.bound_voxels"] = fmt::format("{}", bound_);
            compress::PackedBytes packed = compress::pack(field_, name_, options, progress_);
            const Moved moved = movedBetween(mesh_, polygonize(packed.decoded.field, {}, progress_));
            if (moved.sameTriangles && (!maxDistance_ || moved.largest <= *maxDistance_)) {
                fill(report, options, packed.facts, moved);
                return packed;
            }
            shrink(moved);
        }
        throw OperationError(
            name_, fmt::format("the triangles of level 0 or --max-distance are not kept by a bound of {:g} "
                               "voxels either; pack it without --bound and --max-distance",
                               bound_));
    }

  private:
    void shrink(const Moved& moved) {
        const double factor = moved.sameTriangles ? *maxDistance_ / moved.largest : kLeastShrinking;
        bound_ *= std::clamp(factor, kMostShrinking, kLeastShrinking);
        progress_.say(fmt::format("{}: {}; trying a bound of {:.3g} voxels", name_,
                                  moved.sameTriangles ? "a vertex moves farther than --max-distance"
                                                      : "the triangles of level 0 would change",
                                  bound_));
    }
    void fill(PackReport& report, const compress::PackOptions& options, const compress::PackFacts& facts,
              const Moved& moved) const {
        report.boundVoxels = bound_;
        report.voxelsPerK = options.voxelsPerK;
        report.stepVoxels = facts.delta;
        report.largestVoxels = facts.largest;
        report.rmsVoxels = facts.rms;
        report.largestDistance = moved.largest;
        report.rmsDistance = moved.rms;
        report.triangles = static_cast<std::int64_t>(mesh_.triangles.size());
    }

    const BSplineField& field_;
    const std::string& name_;
    const Progress& progress_;
    TriangleMesh mesh_;
    std::optional<double> maxDistance_;  // world units
    double bound_ = 0;                   // voxels
};

std::map<std::string, std::string> withOrder(std::map<std::string, std::string> source,
                                             const StepOrder& order) {
    if (!order.first.empty()) source[kFirstLevels] = lod::valueOf(wavelets::textOf(order));
    return source;
}

std::map<std::string, std::string> sourceOf(const Solid& solid) {
    const InputReport& input = solid.input();
    return withOrder(
        input.kind == InputReport::Kind::pyramid ? input.source : lod::sourceOf(input, solid.fit()),
        solid.order());
}

// Taken out of the source.
StepOrder takeOrder(std::map<std::string, std::string>& source, const std::string& name) {
    const auto found = source.find(kFirstLevels);
    if (found == source.end()) return {};
    std::string text = found->second;
    std::erase(text, '"');
    const std::optional<StepOrder> order = wavelets::orderOf(text);
    if (!order)
        throw InputError(name, fmt::format("'{}' is {}, expected axes such as \"xy xy\"; the file is damaged",
                                           kFirstLevels, found->second));
    source.erase(found);
    return *order;
}

void fill(PackReport& report, const compress::PackFacts& facts) {
    report.controlPoints = facts.points;
    report.bytes = facts.bytes;
    report.headBytes = facts.headBytes;
    report.nodeBytes = facts.nodeBytes;
    report.signBytes = facts.signBytes;
    report.valueBytes = facts.valueBytes;
    report.chunks = facts.chunks;
}

}  // namespace

PackReport pack(Solid solid, const std::filesystem::path& path, const PackOptions& options,
                const Progress& progress) {
    requirePositive(options.bound, "--bound");
    requirePositive(options.maxDistance, "--max-distance");
    StageClock clock;
    PackReport report;
    compress::PackOptions how{.source = sourceOf(solid)};
    const std::string name = solid.input().path;
    const std::optional<FitSummary> fit = solid.fit();
    const BSplineField field = lod::fieldAtStep(std::move(solid), 0, progress, clock);
    compress::PackedBytes packed;
    if (options.bound || options.maxDistance) {
        how.voxelsPerK = lod::voxelsPerKOf(fit, field, name, progress);
        packed = BoundedPacking(field, name, options, progress).run(how, report);
    } else {
        packed = compress::pack(field, name, how, progress);
    }
    fill(report, packed.facts);
    compress::writeFile(path, packed.bytes);
    report.seconds = clock.secondsSoFar();
    return report;
}

namespace lod {

double voxelsPerKOf(const std::optional<FitSummary>& fit, const BSplineField& field, const std::string& name,
                    const Progress& progress) {
    if (fit && fit->method == FitMethod::distance && fit->halfWidth > 0) return fit->halfWidth;
    return compress::measuredVoxelsPerK(field, name, progress);
}

// Seen: about 60 bytes a control point while decoding, and the grids beside.
double mostPackedPoints(const std::optional<double>& maxMemory) {
    constexpr double kBytesPerPoint = 80;
    return memoryLimit(maxMemory) / kBytesPerPoint;
}

PackedSolid openPacked(const std::filesystem::path& path, const std::optional<double>& maxMemory,
                       const Progress& progress) {
    compress::PackedField packed = compress::readPacked(path, mostPackedPoints(maxMemory), progress);
    if (packed.bound)
        progress.say(fmt::format("{}: level 0 is within {:g} voxels of what was packed, not to the bit",
                                 path.string(), *packed.bound));
    PackedSolid solid{std::move(packed.field), takeOrder(packed.source, path.string()), {}};
    solid.source = std::move(packed.source);
    return solid;
}

void packExactly(const BSplineField& level0, const wavelets::Pyramid& pyramid,
                 const std::filesystem::path& path) {
    const compress::PackOptions options{.source = withOrder(pyramid.source, pyramid.order)};
    compress::writeFile(path, compress::pack(level0, path.string(), options).bytes);
}

}  // namespace lod
}  // namespace isowave
