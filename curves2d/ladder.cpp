#include "curves2d/ladder.h"

#include <fmt/format.h>

#include <algorithm>

#include "isowave/error.h"
#include "curves2d/bitmap.h"
#include "curves2d/polygon_input.h"
#include "curves2d/raster.h"

namespace isowave::curves2d {
namespace {

Input readImageInput(const std::filesystem::path& path, const InputOptions& options) {
    Input input;
    const Bitmap bitmap = readBitmap(path);
    const ValueRange range = valueRange(bitmap);
    const double middle = 0.5 * (static_cast<double>(range.low) + static_cast<double>(range.high));
    double iso = options.iso.value_or(middle);
    if (range.low == range.high && !options.iso)
        throw InputError(path.string(),
                         fmt::format("every pixel is {}: there is no crossing to draw; --iso makes "
                                     "all of it inside or outside",
                                     range.low));
    if (!options.iso && !range.twoValues)
        input.remarks.push_back(
            fmt::format("--iso {:g}: the middle of the values {:g} .. {:g}", middle, range.low, range.high));
    input.shape = shapeOf(bitmap, iso, options.invert, path.string());
    input.extent.take(Point{-0.5, -0.5});
    input.extent.take(Point{bitmap.width - 0.5, bitmap.height - 0.5});
    input.fit = range.twoValues ? Fit::binary : Fit::distance;
    input.kind = fmt::format("image {} x {}", bitmap.width, bitmap.height);
    return input;
}

Input readPolygonInput(const std::filesystem::path& path, const InputOptions& options,
                       const Progress& progress) {
    Input input;
    const PolygonInput polygons = readPolygons(path);
    for (const Polygon& polygon : polygons.polygons)
        for (const Ring& ring : polygon.rings)
            for (const Point& p : ring) input.extent.take(p);
    try {
        input.shape.frame = frameAround(polygons.polygons, options.pixels);
        input.shape.inside = rasterise(polygons.polygons, input.shape.frame, progress);
    } catch (const InputError& error) {
        throw InputError(path.string(), error.what());
    }
    if (input.shape.inside.empty())
        throw InputError(
            path.string(),
            fmt::format("no pixel's middle lies in a polygon at --pixels {}; take more", options.pixels));
    input.shape.boundary = boundary(polygons.polygons, input.shape.frame);
    input.yUp = true;
    input.pixel = input.shape.frame.spacing.x;
    input.kind = fmt::format("{} polygons of {} rings, {} points", polygons.polygons.size(),
                             polygons.ringCount(), polygons.pointCount());
    input.remarks = polygons.remarks;
    return input;
}

constexpr int kMostSamples = 64;

}  // namespace

Input readInput(const std::filesystem::path& path, const InputOptions& options, const Progress& progress) {
    progress("reading", 0);
    if (!std::filesystem::exists(path)) throw InputError(path.string(), "there is no such file");
    return looksLikePolygons(path) ? readPolygonInput(path, options, progress)
                                   : readImageInput(path, options);
}

RowField<float> fit(const Shape& shape, Fit method, const DistanceFitOptions& options, FitReport* report,
                    const Progress& progress) {
    return method == Fit::binary ? fitBinary<float>(shape, {.K = options.K}, report, progress)
                                 : fitDistance<float>(shape, options, report, progress);
}

std::vector<Segment> segmentsOf(const Curves& curves) {
    std::vector<Segment> segments;
    segments.reserve(curves.pointCount());
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        const Ring ring = curves.world(r);
        for (std::size_t i = 0; i < ring.size(); ++i)
            segments.push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
    return segments;
}

// Samples at the middles of equal parts, each weighing its part's length.
Distance distanceTo(const SegmentTree& target, const Curves& curves, double spacing) {
    Distance result;
    double weight = 0, sum = 0;
    for (const Segment& s : segmentsOf(curves)) {
        const double size = length(s.b - s.a);
        const int parts = static_cast<int>(std::clamp(std::ceil(size / spacing), 1.0, double(kMostSamples)));
        for (int k = 0; k < parts; ++k) {
            const double d = target.distance(s.a + ((k + 0.5) / parts) * (s.b - s.a));
            result.max = std::max(result.max, d);
            sum += d * d * size / parts;
        }
        weight += size;
    }
    result.rms = weight > 0 ? std::sqrt(sum / weight) : 0;
    return result;
}

Ladder climb(RowField<float> field, std::optional<int> lastStep, const LadderVisitor& visit,
             const Progress& progress) {
    Ladder ladder;
    std::optional<SegmentTree> finest;
    double spacing = 0;
    const auto onStep = [&](int step, const RowField<float>& f) {
        const Curves curves = extractCurves(f, progress);
        StepFacts facts;
        facts.step = step;
        const Bounds box = f.bounds();
        facts.domain = {box.size(0), box.size(1)};
        facts.controlPoints = f.controlPointCount();
        facts.nodes = definedNodeCount(f);
        facts.holes = curves.holeCount();
        facts.rings = curves.outerCount();
        facts.points = curves.pointCount();
        facts.area = curves.area();
        if (step == 0) {
            spacing = std::min(f.frame.spacing.x, f.frame.spacing.y);
            finest.emplace(segmentsOf(curves));
        } else {
            const Distance d = distanceTo(*finest, curves, spacing);
            facts.maxToLevel0 = d.max;
            facts.rmsToLevel0 = d.rms;
        }
        ladder.steps.push_back(facts);
        if (visit) visit(facts, f, curves);
    };
    const Pyramid<float> pyramid =
        analyse<float>(std::move(field), lastStep.value_or(1000), progress, onStep);
    ladder.coefficients = pyramid.coefficientCount();
    ladder.controlPoints = ladder.steps.front().controlPoints;
    return ladder;
}

}  // namespace isowave::curves2d
