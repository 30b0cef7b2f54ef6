// isowave curves INPUT -o FOLDER: bitmap or polygons -> fit -> every step's curves as it passes by; one file
// a level, put into the folder at once at the end, and on request a table, a sheet and a report.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <optional>

#include "base/atomic_file.h"
#include "isowave/error.h"
#include "curves2d/draw.h"
#include "curves2d/ladder.h"
#include "curves2d/polygon_input.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/repair_json.h"
#include "tools/report.h"

namespace isowave::tools {
namespace {

constexpr int kStepsPerPlaneLevel = 2;
constexpr double kSmoothTolerance = 0.1;  // pixels
constexpr double kSheetTolerance = 1e-3;  // of the picture's longer side

std::string extensionOf(CurveFormat format) {
    switch (format) {
        case CurveFormat::svg:
            return ".svg";
        case CurveFormat::geojson:
            return ".geojson";
        case CurveFormat::png:
            return ".png";
        case CurveFormat::txt:
            return ".txt";
    }
    return "";
}

void refuseContradictions(const Settings& settings) {
    const CurveFormat format = settings.curveFormat.value_or(CurveFormat::svg);
    if (settings.smooth && format != CurveFormat::svg)
        throw UsageError("--smooth writes Bezier curves, which only --format svg has");
    if (settings.band.value_or(2) > settings.halfWidth.value_or(4))
        throw UsageError("--band is larger than --half-width; distances are known up to the half-width only");
}

// What the input has no use for is refused, as lod does.
void refuseForeignOptions(const Settings& settings) {
    const bool polygons = curves2d::looksLikePolygons(settings.files[0]);
    const struct {
        const char* name;
        bool given, ofPolygons;
    } table[] = {{"--pixels", settings.pixels.has_value(), true},
                 {"--iso", settings.iso.has_value(), false},
                 {"--invert", settings.invert, false}};
    for (const auto& option : table)
        if (option.given && option.ofPolygons != polygons)
            throw UsageError(fmt::format("{} has no meaning for {}, which {}; leave it out", option.name,
                                         settings.files[0].string(),
                                         polygons ? "holds polygons" : "is an image"));
}

curves2d::InputOptions inputOptions(const Settings& settings) {
    curves2d::InputOptions options;
    options.iso = settings.iso;
    options.invert = settings.invert;
    if (settings.pixels) options.pixels = *settings.pixels;
    return options;
}

curves2d::Fit fitMethod(const Settings& settings, const curves2d::Input& input) {
    if (!settings.fit) return input.fit;
    return *settings.fit == FitMethod::binary ? curves2d::Fit::binary : curves2d::Fit::distance;
}

Json fitJson(curves2d::Fit method, const curves2d::DistanceFitOptions& options,
             const curves2d::FitReport& report) {
    Json json;
    json["method"] = method == curves2d::Fit::binary ? "binary" : "distance";
    if (method == curves2d::Fit::distance) {
        json["half_width"] = options.halfWidth;
        json["band"] = options.band;
    }
    addRepair(json, report);
    return json;
}

struct Fitted {
    curves2d::RowField<float> field;
    Json json;  // how it went
};

Fitted fitted(const Settings& settings, const curves2d::Input& input, Console& console) {
    curves2d::DistanceFitOptions options;
    if (settings.halfWidth) options.halfWidth = *settings.halfWidth;
    options.band = settings.band.value_or(std::min(options.band, options.halfWidth));
    curves2d::FitReport report;
    const curves2d::Fit method = fitMethod(settings, input);
    auto field = curves2d::fit(input.shape, method, options, &report, console.progress());
    if (report.disagreeing)
        console.say(fmt::format("{} of {} lattice points have another sign than the input",
                                report.disagreeing, report.latticePoints));
    return {std::move(field), fitJson(method, options, report)};
}

// Writes the wanted levels and keeps the rows of table and report.
class Scribe {
  public:
    Scribe(const Settings& settings, const curves2d::Input& input, OutputFolder& out)
        : settings_(settings), input_(input), out_(out), view_{input.extent, input.yUp} {}

    void visit(const curves2d::StepFacts& facts, const curves2d::RowField<float>& field,
               const curves2d::Curves& curves) {
        if (!wanted(facts.step)) return;
        const bool whole = facts.step % kStepsPerPlaneLevel == 0;
        std::optional<std::string> file;
        if (whole && !curves.rings.empty()) {
            file =
                fmt::format("{}_L{}{}", out_.name(), facts.step / kStepsPerPlaneLevel, extensionOf(format()));
            write(*file, facts, field, curves);
        }
        if (settings_.sheet && whole && !curves.rings.empty()) {
            const Point2 size = input_.extent.high - input_.extent.low;
            panels_.push_back({curves2d::stepName(facts.step),
                               curves2d::refined(field, curves, kSheetTolerance * std::max(size.x, size.y))});
        }
        putRow(facts);
        putJson(facts, file);
    }

    std::string sheet() const { return curves2d::sheetOf(panels_, view_); }
    const Table& table() const { return table_; }
    const Json& steps() const { return steps_; }
    std::size_t filesWritten() const { return files_; }
    // Largest distance of a smooth curve from the zero set, pixels; pieces that no halving brought so near.
    double smoothDeviation() const { return deviation_ / input_.pixel; }
    std::size_t straightPieces() const { return straightPieces_; }

  private:
    using Point2 = curves2d::Point;

    CurveFormat format() const { return settings_.curveFormat.value_or(CurveFormat::svg); }

    bool wanted(int step) const {
        if (!settings_.levels) return true;
        const StepRange& range = *settings_.levels;
        return step >= range.first * kStepsPerPlaneLevel &&
               (!range.last || step <= *range.last * kStepsPerPlaneLevel);
    }

    void write(const std::string& name, const curves2d::StepFacts& facts,
               const curves2d::RowField<float>& field, const curves2d::Curves& all) {
        const std::filesystem::path place = out_.place(name);
        ++files_;
        if (settings_.smooth) {
            const double tolerance = settings_.tolerance.value_or(kSmoothTolerance) * input_.pixel;
            const curves2d::SmoothCurves smooth = curves2d::smoothed(field, all, tolerance);
            deviation_ = std::max(deviation_, smooth.deviation);
            straightPieces_ += smooth.straightPieces;
            curves2d::writeSvg(place, smooth, view_);
            return;
        }
        const curves2d::Curves curves =
            settings_.tolerance ? curves2d::refined(field, all, *settings_.tolerance * input_.pixel) : all;
        switch (format()) {
            case CurveFormat::svg:
                curves2d::writeSvg(place, curves, view_);
                break;
            case CurveFormat::geojson:
                curves2d::writeGeojson(place, curves,
                                       fmt::format("{} {}", out_.name(), curves2d::stepName(facts.step)));
                break;
            case CurveFormat::png:
                curves2d::writePng(place, curves, view_);
                break;
            case CurveFormat::txt:
                curves2d::writeText(place, curves);
                break;
        }
    }

    void putRow(const curves2d::StepFacts& f) {
        table_.row({curves2d::stepName(f.step), fmt::format("{}x{}", f.domain[0], f.domain[1]),
                    grouped(f.controlPoints), grouped(f.nodes), grouped(static_cast<std::int64_t>(f.rings)),
                    grouped(static_cast<std::int64_t>(f.holes)), grouped(static_cast<std::int64_t>(f.points)),
                    shortNumber(f.area)});
    }

    void putJson(const curves2d::StepFacts& f, const std::optional<std::string>& file) {
        Json json;
        json["step"] = f.step;
        json["level"] =
            f.step % kStepsPerPlaneLevel == 0 ? Json(f.step / kStepsPerPlaneLevel) : Json(nullptr);
        json["file"] = file ? Json(*file) : Json(nullptr);
        json["domain"] = f.domain;
        json["control_points"] = f.controlPoints;
        json["nodes"] = f.nodes;
        json["rings"] = f.rings;
        json["holes"] = f.holes;
        json["points"] = f.points;
        json["area"] = f.area;
        const bool known = f.points > 0;
        json["max_to_level0"] = known ? finite(f.maxToLevel0) : Json(nullptr);
        json["rms_to_level0"] = known ? finite(f.rmsToLevel0) : Json(nullptr);
        steps_.push_back(std::move(json));
    }

    const Settings& settings_;
    const curves2d::Input& input_;
    OutputFolder& out_;
    curves2d::View view_;
    std::vector<curves2d::Panel> panels_;
    Table table_{{"step", "domain", "|I|", "nodes", "rings", "holes", "points", "area"}};
    Json steps_ = Json::array();
    std::size_t files_ = 0;
    double deviation_ = 0;
    std::size_t straightPieces_ = 0;
};

Json reportOf(const Settings& settings, const curves2d::Input& input, const Json& fit, const Scribe& scribe,
              const curves2d::Ladder& ladder) {
    Json json;
    json["version"] = 1;
    json["input"] = {{"path", settings.files[0].string()}, {"kind", input.kind}, {"pixel", input.pixel}};
    json["fit"] = fit;
    if (settings.smooth)
        json["smooth"] = {{"deviation", scribe.smoothDeviation() * input.pixel},
                          {"straight_pieces", scribe.straightPieces()}};
    json["steps"] = scribe.steps();
    json["coefficients_stored"] = ladder.coefficients;
    json["control_points"] = ladder.controlPoints;
    json["peak_memory_bytes"] = peakMemoryBytes();
    return json;
}

}  // namespace

int runCurves(const Settings& settings, Console& console) {
    refuseContradictions(settings);
    refuseForeignOptions(settings);
    OutputFolder out(*settings.output, Inputs(settings.files));
    const bool toStdout = settings.jsonFile == "-";
    if (settings.jsonFile && !toStdout) out.keepFree(*settings.jsonFile);
    if (settings.sheet) out.keepFree(*settings.sheet);
    std::optional<AtomicFile> copy;  // opened now: a place that cannot be written is found before the work
    if (settings.jsonFile && !toStdout) copy.emplace(*settings.jsonFile);
    std::optional<tbb::global_control> limit;
    if (settings.threads)
        limit.emplace(tbb::global_control::max_allowed_parallelism,
                      static_cast<std::size_t>(settings.threads));

    curves2d::Input input =
        curves2d::readInput(settings.files[0], inputOptions(settings), console.progress());
    for (const std::string& remark : input.remarks) console.say(remark);
    Fitted fit = fitted(settings, input, console);
    input.shape = {};  // as large as the field

    Scribe scribe(settings, input, out);
    std::optional<int> lastStep;
    if (settings.levels && settings.levels->last) lastStep = *settings.levels->last * kStepsPerPlaneLevel;
    const curves2d::Ladder ladder = curves2d::climb(
        std::move(fit.field), lastStep,
        [&](const auto& facts, const auto& f, const auto& curves) { scribe.visit(facts, f, curves); },
        console.progress());
    if (settings.levels && ladder.steps.back().step < settings.levels->first * kStepsPerPlaneLevel)
        throw InputError(settings.files[0].string(),
                         fmt::format("ends at level {} with one node left; --levels begins at {}",
                                     ladder.steps.back().step / kStepsPerPlaneLevel, settings.levels->first));

    const Json report = reportOf(settings, input, fit.json, scribe, ladder);
    // What can fail for want of room comes first; then only names change.
    std::optional<OutputFile> sheetPlace;
    std::optional<AtomicFile> sheet;
    if (settings.sheet) {
        sheetPlace.emplace(*settings.sheet);
        sheet.emplace(*settings.sheet);
        writeWhole(*sheet, scribe.sheet());
    }
    if (copy) writeJson(*copy, report);
    out.commit();
    if (sheet) {
        sheet->commit();
        sheetPlace->commit();
    }
    if (copy) copy->commit();
    if (toStdout) console.print(textOf(report));
    if (settings.table) console.print(scribe.table().text());
    if (settings.smooth) {
        const std::string straight =
            scribe.straightPieces()
                ? fmt::format("; {} pieces in squares that hold a sharp bend are straight",
                              grouped(static_cast<std::int64_t>(scribe.straightPieces())))
                : "";
        console.say(fmt::format("the smooth curves stay within {} pixels of the zero set{}",
                                shortNumber(scribe.smoothDeviation()), straight));
    }
    if (!toStdout)
        console.print(fmt::format(
            "{}: {}, {} control points, {} coefficients (+{:.1f} %), {} files\n", out.folder().string(),
            input.kind, grouped(ladder.controlPoints), grouped(ladder.coefficients),
            100.0 * (static_cast<double>(ladder.coefficients) /
                         static_cast<double>(std::max<std::int64_t>(1, ladder.controlPoints)) -
                     1),
            scribe.filesWritten()));
    return 0;
}

}  // namespace isowave::tools
