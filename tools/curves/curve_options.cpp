#include "tools/curves/curve_options.h"

#include <fmt/format.h>

#include "curves2d/file/pyramid_file.h"
#include "curves2d/polygon_input.h"
#include "isowave/error.h"
#include "tools/option_values.h"

namespace isowave::tools {

void CurveOptions::declareLevels(OptionList& options) {
    options.value("--levels", "A..B", "0 until one node is left", "which levels (A.., ..B and A will do)",
                  [this](const std::string& v) { levels = range(v); });
    options.value("--steps", "A..B", "",
                  "steps instead of levels, files L0, L0a, L1, ...; two steps are a level, and those between "
                  "levels are the wavelet steps as they are",
                  [this](const std::string& v) { steps = range(v); });
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
                  [this](const std::string& v) { draw.tolerance = lengthIn(v, kPixels); });
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
    options.value("--half-width", "W", "4",
                  "distance fit: the distance is clamped to W voxels each side, at most 64",
                  [this](const std::string& v) { halfWidth = lengthIn(v, "pixels"); });
    options.value("--band", "B", "2", "distance fit: nodes nearer than B voxels are kept; at most W",
                  [this](const std::string& v) { band = lengthIn(v, "pixels"); });
}

void CurveOptions::declareEdits(OptionList& options) {
    for (const bool cut : {false, true})
        options.values(
            cut ? "--cut" : "--add", "FILE",
            cut ? "take these polygons away from what was fitted; may be given several times"
                : "add these polygons to what was fitted, before the ladder is climbed; may be given several "
                  "times, in any order with --cut",
            [this, cut](const std::string& v) {
                edits.push_back({cut, v});
            });
    options.value("--edit-level", "L", "0",
                  "polygons of --add and --cut are as fine as level L: sampled on its lattice",
                  [this](const std::string& v) { editLevel = static_cast<int>(integer(v, 0, 20)); });
}

std::vector<std::filesystem::path> CurveOptions::inputs(const std::filesystem::path& input) const {
    std::vector<std::filesystem::path> all{input};
    for (const Edit& edit : edits) all.push_back(edit.file);
    return all;
}

curves2d::Input CurveOptions::prepared(curves2d::Input input, const Progress& progress) const {
    if (edits.empty() && !pyramid) return input;
    input = curves2d::fitted(std::move(input), ladder(), progress);
    for (const Edit& edit : edits) {
        const curves2d::PolygonInput tool = curves2d::readPolygons(edit.file);
        for (const std::string& remark : tool.remarks) progress.say(edit.file.string() + ": " + remark);
        input = curves2d::edited(std::move(input), {edit.cut, tool.polygons, editLevel.value_or(0)},
                                 edit.file.string(), progress);
    }
    return input;
}

void CurveOptions::declarePyramid(OptionList& options) {
    options.result("--pyramid", "FILE",
                   "the fitted input, losslessly compressed, which curves takes in place of INPUT (.iwc)",
                   pyramid);
}

curves2d::InputOptions CurveOptions::input() const {
    curves2d::InputOptions options;
    options.iso = iso;
    options.invert = invert;
    if (pixels) options.pixels = *pixels;
    return options;
}

curves2d::LadderOptions CurveOptions::ladder() const {
    if (constexpr double kWidest = 64; halfWidth.value_or(4) > kWidest)
        throw UsageError(
            fmt::format("--half-width {} is more than {} pixels; the field is known near the curve alone",
                        *halfWidth, kWidest));
    if (band.value_or(2) > halfWidth.value_or(4))
        throw UsageError("--band is larger than --half-width; distances are known up to the half-width only");
    if (pyramid && !curves2d::isPyramidPath(*pyramid))
        throw UsageError("--pyramid: '" + pyramid->string() +
                         "' does not end in .iwc, which tells a pyramid");
    if (editLevel && edits.empty()) throw UsageError("--edit-level: belongs to --add and --cut");
    curves2d::LadderOptions options;
    options.fit = fit;
    if (halfWidth) options.halfWidth = *halfWidth;
    options.band = band;
    options.hold = hold;
    if (levels && steps) throw UsageError("--levels and --steps exclude each other; level L is step 2L");
    if (!levels && !steps) return options;
    const StepRange& range = steps ? *steps : *levels;
    const int each = steps ? 1 : kStepsPerPlaneLevel;
    options.firstStep = range.first * each;
    if (range.last) options.lastStep = *range.last * each;
    return options;
}

namespace {

std::string_view describe(CurveInput kind) {
    switch (kind) {
        case CurveInput::image:
            return "is an image";
        case CurveInput::polygons:
            return "holds polygons";
        case CurveInput::pyramid:
            return "is a pyramid, fitted already";
    }
    return "";
}

}  // namespace

CurveInput curveInputOf(const std::filesystem::path& path) {
    if (curves2d::isPyramidPath(path)) return CurveInput::pyramid;
    return curves2d::looksLikePolygons(path) ? CurveInput::polygons : CurveInput::image;
}

void CurveOptions::refuseForeign(const std::string& name, CurveInput kind) const {
    const struct {
        const char* name;
        bool given, ofImages, ofPolygons;
    } table[] = {{"--pixels", pixels.has_value(), false, true},
                 {"--iso", iso.has_value(), true, false},
                 {"--invert", invert, true, false},
                 {"--fit", fit.has_value(), true, true},
                 {"--half-width", halfWidth.has_value(), true, true},
                 {"--band", band.has_value(), true, true}};
    for (const auto& option : table) {
        const bool suits = (kind == CurveInput::image && option.ofImages) ||
                           (kind == CurveInput::polygons && option.ofPolygons);
        if (option.given && !suits)
            throw UsageError(fmt::format("{} has no meaning for {}, which {}; leave it out", option.name,
                                         name, describe(kind)));
    }
}

std::vector<std::string> CurveOptions::remarks() const {
    if (!steps || hold == curves2d::Hold::none) return {};
    return {"levels hold what is thin; the steps between them do not (--hold)"};
}

void requireFirstLevel(const CurveOptions& options, const curves2d::Ladder& ladder, const std::string& name) {
    const int last = ladder.steps.back().step;
    if (last >= options.ladder().firstStep) return;
    const std::string_view end = ladder.steps.back().points == 0 ? "nothing is left" : "one node is left";
    if (options.steps)
        throw InputError(name, fmt::format("ends at step {}, where {}; --steps begins at {}", last, end,
                                           options.steps->first));
    throw InputError(name, fmt::format("ends at level {}, where {}; --levels begins at {}",
                                       last / kStepsPerPlaneLevel, end, options.levels->first));
}

}  // namespace isowave::tools
