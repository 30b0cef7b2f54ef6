#include "tools/curves/curve_options.h"

#include <fmt/format.h>

#include "isowave/error.h"
#include "tools/option_values.h"

namespace isowave::tools {

void CurveOptions::declareLevels(OptionList& options) {
    options.value("--levels", "A..B", "0 until one node is left", "which levels (A.., ..B and A will do)",
                  [this](const std::string& v) { levels = range(v); });
    options.value("--hold", "local|none", "local",
                  "local: what is thinner than a level's pixel stays whole, and no level has more parts or "
                  "holes than the one before; none: the wavelet levels as they are",
                  [this](const std::string& v) {
                      hold = choice<curves2d::Hold>(
                          v, {{"local", curves2d::Hold::local}, {"none", curves2d::Hold::none}});
                  });
}

void CurveOptions::declareDrawing(OptionList& options) {
    options.flag("--smooth", "SVG: cubic Beziers along the zero set instead of straight pieces", draw.smooth);
    options.value("--flatness", "T", "smooth: 0.1; otherwise no added points",
                  "the drawn curve stays within T pixels of level 0 of the zero set, by added points",
                  [this](const std::string& v) { draw.tolerance = positive(v); });
}

void CurveOptions::declareInput(OptionList& options) {
    options.value(
        "--iso", "V", "the middle of the range of values",
        "images: the curve is where the value is V; inside is where it is larger, on light ground where it "
        "is not",
        [this](const std::string& v) { iso = number(v); });
    options.value("--pixels", "N", "1024", "polygons: sample with N pixels along the longer side",
                  [this](const std::string& v) {
                      pixels = static_cast<std::int32_t>(integer(v, 1, std::int64_t{1} << 22));
                  });
    options.flag("--invert", "images: the ground is inside, and not what is taken for the drawing", invert);
}

void CurveOptions::declareFit(OptionList& options) {
    options.value("--fit", "binary|distance", "binary for masks and labels, otherwise distance",
                  "from signs alone (filtered weights), or from signed distances",
                  [this](const std::string& v) {
                      fit = choice<curves2d::Fit>(
                          v, {{"binary", curves2d::Fit::binary}, {"distance", curves2d::Fit::distance}});
                  });
    options.value("--half-width", "W", "4", "distance fit: the distance is clamped to W voxels each side",
                  [this](const std::string& v) { halfWidth = positive(v); });
    options.value("--band", "B", "2", "distance fit: nodes nearer than B voxels are kept; at most W",
                  [this](const std::string& v) { band = positive(v); });
}

curves2d::InputOptions CurveOptions::input() const {
    curves2d::InputOptions options;
    options.iso = iso;
    options.invert = invert;
    if (pixels) options.pixels = *pixels;
    return options;
}

curves2d::LadderOptions CurveOptions::ladder() const {
    if (band.value_or(2) > halfWidth.value_or(4))
        throw UsageError("--band is larger than --half-width; distances are known up to the half-width only");
    curves2d::LadderOptions options;
    options.fit = fit;
    if (halfWidth) options.halfWidth = *halfWidth;
    options.band = band;
    options.hold = hold;
    if (!levels) return options;
    options.firstStep = levels->first * kStepsPerPlaneLevel;
    if (levels->last) options.lastStep = *levels->last * kStepsPerPlaneLevel;
    return options;
}

void CurveOptions::refuseForeign(const std::string& name, bool polygons) const {
    const struct {
        const char* name;
        bool given, ofPolygons;
    } table[] = {{"--pixels", pixels.has_value(), true},
                 {"--iso", iso.has_value(), false},
                 {"--invert", invert, false}};
    for (const auto& option : table)
        if (option.given && option.ofPolygons != polygons)
            throw UsageError(fmt::format("{} has no meaning for {}, which {}; leave it out", option.name,
                                         name, polygons ? "holds polygons" : "is an image"));
}

void requireFirstLevel(const CurveOptions& options, const curves2d::Ladder& ladder, const std::string& name) {
    const int last = ladder.steps.back().step;
    if (!options.levels || last >= options.levels->first * kStepsPerPlaneLevel) return;
    throw InputError(
        name, fmt::format("ends at level {}, where {}; --levels begins at {}", last / kStepsPerPlaneLevel,
                          ladder.steps.back().points == 0 ? "nothing is left" : "one node is left",
                          options.levels->first));
}

}  // namespace isowave::tools
