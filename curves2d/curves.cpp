#include "isowave/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <set>
#include <tuple>
#include <utility>

#include "base/read_file.h"
#include "curves2d/bitmap_shape.h"
#include "curves2d/edit/edit.h"
#include "curves2d/file/pyramid_file.h"
#include "curves2d/fit.h"
#include "curves2d/ladder.h"
#include "curves2d/polygon_input.h"
#include "curves2d/raster.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

constexpr double kSmoothTolerance = 0.1;  // pixels
constexpr double kSheetTolerance = 1e-3;  // of the picture's longer side

// What was taken for the drawing.
std::string groundText(bool isOpacity, bool onLight, bool invert) {
    const std::string light = isOpacity ? "opaque" : "light", dark = isOpacity ? "transparent" : "dark";
    const std::string& inside = invert != onLight ? dark : light;
    std::string text = "inside is what is " + inside;
    if (isOpacity && !invert)
        text += ", since the border is transparent";
    else if (onLight && !invert)
        text += ", since the whole border is light";
    return text + (invert ? " (--invert)" : "; --invert turns that round");
}

Input inputOf(const Bitmap& bitmap, const InputOptions& options, const std::string& name) {
    Input input;
    const ValueRange range = valueRange(bitmap);
    const double middle = 0.5 * (static_cast<double>(range.low) + static_cast<double>(range.high));
    if (range.low == range.high && !options.iso)
        throw InputError(name, fmt::format("every pixel is {}: there is no crossing to draw; --iso makes "
                                           "all of it inside or outside",
                                           range.low));
    if (!options.iso && !range.twoValues)
        input.remarks.push_back(
            fmt::format("--iso {:g}: the middle of the values {:g} .. {:g}", middle, range.low, range.high));
    const double iso = options.iso.value_or(middle);
    const bool onLight = hasLightGround(bitmap, iso);
    input.remarks.push_back(groundText(bitmap.isOpacity, onLight, options.invert));
    input.shape = std::make_shared<const Shape>(shapeOf(bitmap, iso, options.invert != onLight, name));
    input.extent.take(Point{-0.5, -0.5});
    input.extent.take(Point{bitmap.width - 0.5, bitmap.height - 0.5});
    input.fit = range.twoValues ? Fit::binary : Fit::distance;
    input.kind = fmt::format("image {} x {}", bitmap.width, bitmap.height);
    return input;
}

// Whether all rings are lines, but for rounding.
bool areFlat(const std::vector<Polygon>& polygons) {
    constexpr double kRounding = 1e-12;  // of the square of a ring's length
    for (const Polygon& polygon : polygons)
        for (const Ring& ring : polygon.rings) {
            double around = 0;
            for (std::size_t k = 0; k < ring.size(); ++k)
                around += length(ring[(k + 1) % ring.size()] - ring[k]);
            if (std::abs(signedArea(ring)) > kRounding * around * around) return false;
        }
    return true;
}

Shape shapeOfPolygons(const std::vector<Polygon>& polygons, const InputOptions& options,
                      const Progress& progress, const std::string& name) {
    Shape shape;
    try {
        shape.frame = frameAround(polygons, options.pixels);
        shape.inside = rasterise(polygons, shape.frame, progress);
    } catch (const InputError& error) {
        throw InputError(name, error.what());
    }
    if (shape.inside.empty() && areFlat(polygons))
        throw InputError(name, "its rings have no area: their points lie on lines; expected polygons");
    if (shape.inside.empty())
        throw InputError(name, fmt::format("no pixel's middle lies in a polygon at --pixels {}; take more",
                                           options.pixels));
    shape.boundary = boundary(polygons, shape.frame);
    return shape;
}

}  // namespace

Input pictureInput(std::int32_t width, std::int32_t height, std::vector<float> values,
                   const InputOptions& options, const std::string& name) {
    if (width < 1 || height < 1 ||
        values.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw InputError(
            name, fmt::format("{} values are no picture of {} x {} pixels", values.size(), width, height));
    Bitmap bitmap{width, height, std::move(values)};
    refuseNotFinite(name, bitmap);
    return inputOf(std::move(bitmap), options, name);
}

namespace {

// Of polygons that have a piece of border in common, in the same points.
std::size_t neighbourCount(const std::vector<Polygon>& polygons) {
    std::vector<std::tuple<double, double, double, double, std::size_t>> pieces;
    for (std::size_t i = 0; i < polygons.size(); ++i)
        for (const Ring& ring : polygons[i].rings)
            for (std::size_t k = 0; k < ring.size(); ++k) {
                Point a = ring[k], b = ring[(k + 1) % ring.size()];
                if (std::pair(b.x, b.y) < std::pair(a.x, a.y)) std::swap(a, b);
                pieces.emplace_back(a.x, a.y, b.x, b.y, i);
            }
    std::sort(pieces.begin(), pieces.end());
    std::set<std::size_t> neighbours;
    for (std::size_t k = 1; k < pieces.size(); ++k) {
        const auto& [ax, ay, bx, by, i] = pieces[k - 1];
        const auto& [cx, cy, dx, dy, j] = pieces[k];
        if (i != j && std::tie(ax, ay, bx, by) == std::tie(cx, cy, dx, dy)) neighbours.insert({i, j});
    }
    return neighbours.size();
}

}  // namespace

Input polygonInput(const std::vector<Polygon>& polygons, const InputOptions& options,
                   const Progress& progress, const std::string& name) {
    Input input;
    std::size_t rings = 0, points = 0;
    for (const Polygon& polygon : polygons) {
        rings += polygon.rings.size();
        for (const Ring& ring : polygon.rings) {
            points += ring.size();
            for (const Point& p : ring) input.extent.take(p);
        }
    }
    auto shape = std::make_shared<const Shape>(shapeOfPolygons(polygons, options, progress, name));
    input.yUp = true;
    input.pixel = shape->frame.spacing.x;
    input.shape = std::move(shape);
    if (const std::size_t neighbours = neighbourCount(polygons))
        input.remarks.push_back(fmt::format(
            "{} of {} polygons share borders, which vanish: the curves are the outline of all together; give "
            "each a file of its own to draw it apart",
            neighbours, polygons.size()));
    input.kind = fmt::format("{} polygons of {} rings, {} points", polygons.size(), rings, points);
    return input;
}

Input readInput(const std::filesystem::path& path, const InputOptions& options, const Progress& progress) {
    progress("reading", 0);
    std::error_code error;
    if (!std::filesystem::exists(path, error))
        throw InputError(path.string(),
                         error ? "cannot be looked at (" + error.message() + ")" : "there is no such file");
    if (isPyramidPath(path)) return readPyramid(readFile(path, "a pyramid of curves"), path.string());
    if (!looksLikePolygons(path)) return inputOf(readBitmap(path), options, path.string());
    const PolygonInput polygons = readPolygons(path);
    Input input = polygonInput(polygons.polygons, options, progress, path.string());
    input.remarks.insert(input.remarks.begin(), polygons.remarks.begin(), polygons.remarks.end());
    return input;
}

DrawnCurves LadderStep::drawn(const DrawOptions& options) const {
    if (options.smooth)
        return {traced_, smoothed(field_, traced_, options.tolerance.value_or(kSmoothTolerance) * pixel_)};
    if (options.tolerance) return {refined(field_, traced_, *options.tolerance * pixel_), std::nullopt};
    return {curves_, std::nullopt};
}

Panel LadderStep::panel(const View& view) const {
    const Point size = view.extent.high - view.extent.low;
    return {name(), refined(field_, traced_, kSheetTolerance * std::max(size.x, size.y))};
}

namespace {

Fitted fit(const Input& input, const LadderOptions& options, const Progress& progress) {
    DistanceFitOptions distance;
    distance.halfWidth = options.halfWidth;
    distance.band = options.band.value_or(std::min(distance.band, options.halfWidth));
    assert(0 < distance.band && distance.band <= distance.halfWidth);
    Fitted made;
    made.method = options.fit.value_or(input.fit);
    made.halfWidth = distance.halfWidth;
    made.band = distance.band;
    made.field = fit(*input.shape, made.method, distance, &made.report, progress);
    return made;
}

}  // namespace

Input fitted(Input input, const LadderOptions& options, const Progress& progress) {
    if (input.fitted) return input;
    input.fitted = std::make_shared<Fitted>(fit(input, options, progress));
    input.shape.reset();
    return input;
}

Input edited(Input input, const PolygonEdit& edit, const std::string& name, const Progress& progress) {
    assert(input.fitted && 0 <= edit.level && edit.level <= 20);
    std::optional<Fitted> result;
    try {
        result = editedFit(*input.fitted, edit, progress);
    } catch (const InputError& error) {
        throw InputError(name, error.what());
    }
    if (!result)
        throw InputError(name, edit.cut ? "cuts nothing away: it lies outside the shape"
                                        : "adds nothing: it lies inside the shape");
    input.fitted = std::make_shared<const Fitted>(std::move(*result));
    if (!edit.cut)
        for (const Polygon& polygon : edit.polygons)
            for (const Ring& ring : polygon.rings)
                for (const Point& p : ring) input.extent.take(p);
    return input;
}

Ladder makeLadder(Input input, const LadderOptions& options, const LadderVisitor& visit,
                  const Progress& progress) {
    Fitted level0 = input.fitted ? *input.fitted : fit(input, options, progress);
    input.shape.reset();  // as large as the field
    input.fitted.reset();

    const auto onStep = [&](const StepFacts& facts, const RowField<float>& f, const Curves& curves,
                            const Curves& traced) {
        if (visit && facts.step >= options.firstStep)
            visit(LadderStep(facts, curves, traced, f, input.pixel));
    };
    Ladder ladder = traceSteps(std::move(level0.field), options.lastStep, options.hold, onStep, progress);
    ladder.fit = level0.method;
    ladder.halfWidth = level0.halfWidth;
    ladder.band = level0.band;
    ladder.fitReport = level0.report;
    return ladder;
}

std::vector<LevelCurves> levelCurves(Input input, const LadderOptions& options, const DrawOptions& draw,
                                     const Progress& progress) {
    std::vector<LevelCurves> levels;
    const auto keep = [&](const LadderStep& step) {
        if (step.level()) levels.push_back({step.facts(), step.drawn(draw)});
    };
    makeLadder(std::move(input), options, keep, progress);
    return levels;
}

}  // namespace isowave::curves2d
