// isowave curves INPUT -o FOLDER: bitmap or polygons -> the curves of every step as it passes by; one file a level, put
// into the folder at once at the end, and on request a table, a sheet and a report.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/atomic_file.h"
#include "base/peak_memory.h"
#include "curves2d/draw.h"
#include "curves2d/polygon_input.h"
#include "isowave/curves.h"
#include "isowave/error.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/curves.h"

namespace isowave::tools {
namespace {

constexpr int kStepsPerPlaneLevel = 2;

enum class CurveFormat { svg, geojson, png, txt };

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

// How the curves are drawn.
struct DrawOptions {
    CurveFormat format = CurveFormat::svg;
    bool smooth = false;
    std::optional<double> flatness;  // pixels of level 0
    std::optional<std::filesystem::path> sheet;
};

// Writes the wanted levels and keeps what the report and the sheet hold.
class LevelWriter {
  public:
    LevelWriter(const DrawOptions& draw, const curves2d::View& view, OutputFolder& out)
        : draw_(draw), view_(view), out_(out) {}

    void visit(const curves2d::LadderStep& step) {
        std::optional<std::string> file;
        if (step.level() && !step.curves().rings.empty()) {
            file = fmt::format("{}_L{}{}", out_.name(), *step.level(), extensionOf(draw_.format));
            write(*file, step);
            if (draw_.sheet) panels_.push_back(step.panel(view_));
        }
        steps_.push_back({step.facts(), file});
    }

    std::string sheet() const { return curves2d::sheetOf(panels_, view_); }
    // deviation: in the input's unit until it is divided by `pixel`.
    void report(double pixel, CurvesReport& report) const {
        report.steps = steps_;
        report.files = files_;
        report.smooth = draw_.smooth;
        report.deviation = deviation_ / pixel;
        report.straightPieces = straightPieces_;
    }

  private:
    void write(const std::string& name, const curves2d::LadderStep& step) {
        const std::filesystem::path place = out_.place(name);
        ++files_;
        const auto [curves, smooth] = step.drawn({draw_.flatness, draw_.smooth});
        if (smooth) {
            deviation_ = std::max(deviation_, smooth->deviation);
            straightPieces_ += smooth->straightPieces;
            curves2d::writeSvg(place, *smooth, view_);
            return;
        }
        switch (draw_.format) {
            case CurveFormat::svg:
                return curves2d::writeSvg(place, curves, view_);
            case CurveFormat::geojson:
                return curves2d::writeGeojson(place, curves, fmt::format("{} {}", out_.name(), step.name()));
            case CurveFormat::png:
                return curves2d::writePng(place, curves, view_);
            case CurveFormat::txt:
                return curves2d::writeText(place, curves);
        }
    }

    const DrawOptions& draw_;
    curves2d::View view_;
    OutputFolder& out_;
    std::vector<curves2d::Panel> panels_;
    std::vector<CurvesReport::Step> steps_;
    std::size_t files_ = 0;
    double deviation_ = 0;
    std::size_t straightPieces_ = 0;
};

class CurvesCommand : public Command {
  public:
    CurvesCommand();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    void declareDrawing();
    void declareInput();
    void declareFit();
    void refuseContradictions() const;
    void refuseForeignOptions() const;
    curves2d::LadderOptions ladderOptions() const;
    CurvesReport climb(OutputFolder& out, Console& console, std::string& sheet) const;
    void tellAll(const CurvesReport& report, const OutputFolder& out, Console& console) const;

    std::optional<StepRange> levels_;
    DrawOptions draw_;
    bool table_ = false;
    std::optional<double> iso_;
    std::optional<std::int32_t> pixels_;
    bool invert_ = false;
    std::optional<curves2d::Fit> fit_;
    std::optional<double> halfWidth_, band_;
    curves2d::Hold hold_ = curves2d::Hold::local;
};

CurvesCommand::CurvesCommand()
    : Command({"curves", "INPUT", "a bitmap or polygons -> a ladder of closed planar curves, one a level",
               "INPUT is an image (PNG, TIFF, BMP, PGM, PBM) or polygons (GeoJSON, TopoJSON, text with rings "
               "as lines "
               "'x y'). -o out/africa makes the folder out/africa with africa_L0.svg, africa_L1.svg, ...; a "
               "level at "
               "which nothing is left has no file. Level L is step 2L: both axes halved L times. Outer rings "
               "have "
               "positive area, holes negative, in the input's own coordinates."}) {
    declareOutput("the folder that gets one file a level");
    options_.value("--levels", "A..B", "0 until one node is left", "which levels (A.., ..B and A will do)",
                   [this](const std::string& v) { levels_ = range(v); });
    options_.value("--hold", "local|none", "local",
                   "local: what is thinner than a level's pixel stays whole, and no level has more parts or "
                   "holes than the one before; none: the wavelet levels as they are",
                   [this](const std::string& v) {
                       hold_ = choice<curves2d::Hold>(
                           v, {{"local", curves2d::Hold::local}, {"none", curves2d::Hold::none}});
                   });
    declareDrawing();
    declareJson();
    declareInput();
    declareFit();
    declareThreads();
    declareTalk();
}

void CurvesCommand::declareDrawing() {
    options_.value("--format", "svg|geojson|png|txt", "svg", "format of the curves",
                   [this](const std::string& v) {
                       draw_.format = choice<CurveFormat>(v, {{"svg", CurveFormat::svg},
                                                              {"geojson", CurveFormat::geojson},
                                                              {"png", CurveFormat::png},
                                                              {"txt", CurveFormat::txt}});
                   });
    options_.flag("--smooth", "SVG: cubic Beziers along the zero set instead of straight pieces",
                  draw_.smooth);
    options_.value("--flatness", "T", "smooth: 0.1; otherwise no added points",
                   "the drawn curve stays within T pixels of level 0 of the zero set, by added points",
                   [this](const std::string& v) { draw_.flatness = positive(v); });
    options_.flag("--table", "print a table of the steps: domain, control points, nodes, rings, area",
                  table_);
    options_.result("--sheet", "FILE", "one SVG with all levels side by side", draw_.sheet);
}

void CurvesCommand::declareInput() {
    options_.value(
        "--iso", "V", "the middle of the range of values",
        "images: the curve is where the value is V; inside is where it is larger, on light ground where it "
        "is not",
        [this](const std::string& v) { iso_ = number(v); });
    options_.value("--pixels", "N", "1024", "polygons: sample with N pixels along the longer side",
                   [this](const std::string& v) {
                       pixels_ = static_cast<std::int32_t>(integer(v, 1, std::int64_t{1} << 22));
                   });
    options_.flag("--invert", "images: the ground is inside, and not what is taken for the drawing", invert_);
}

void CurvesCommand::declareFit() {
    options_.value("--fit", "binary|distance", "binary for masks and labels, otherwise distance",
                   "from signs alone (filtered weights), or from signed distances",
                   [this](const std::string& v) {
                       fit_ = choice<curves2d::Fit>(
                           v, {{"binary", curves2d::Fit::binary}, {"distance", curves2d::Fit::distance}});
                   });
    options_.value("--half-width", "W", "4", "distance fit: the distance is clamped to W voxels each side",
                   [this](const std::string& v) { halfWidth_ = positive(v); });
    options_.value("--band", "B", "2", "distance fit: nodes nearer than B voxels are kept; at most W",
                   [this](const std::string& v) { band_ = positive(v); });
}

void CurvesCommand::refuseContradictions() const {
    if (draw_.smooth && draw_.format != CurveFormat::svg)
        throw UsageError("--smooth writes Bezier curves, which only --format svg has");
    if (band_.value_or(2) > halfWidth_.value_or(4))
        throw UsageError("--band is larger than --half-width; distances are known up to the half-width only");
}

// What the input has no use for is refused, as lod does.
void CurvesCommand::refuseForeignOptions() const {
    const bool polygons = curves2d::looksLikePolygons(arguments[0]);
    const struct {
        const char* name;
        bool given, ofPolygons;
    } table[] = {{"--pixels", pixels_.has_value(), true},
                 {"--iso", iso_.has_value(), false},
                 {"--invert", invert_, false}};
    for (const auto& option : table)
        if (option.given && option.ofPolygons != polygons)
            throw UsageError(fmt::format("{} has no meaning for {}, which {}; leave it out", option.name,
                                         arguments[0].string(), polygons ? "holds polygons" : "is an image"));
}

curves2d::LadderOptions CurvesCommand::ladderOptions() const {
    curves2d::LadderOptions options;
    options.fit = fit_;
    if (halfWidth_) options.halfWidth = *halfWidth_;
    options.band = band_;
    options.hold = hold_;
    if (!levels_) return options;
    options.firstStep = levels_->first * kStepsPerPlaneLevel;
    if (levels_->last) options.lastStep = *levels_->last * kStepsPerPlaneLevel;
    return options;
}

// Climbs the ladder, writes the levels into `out`, and says what came of it.
CurvesReport CurvesCommand::climb(OutputFolder& out, Console& console, std::string& sheet) const {
    curves2d::InputOptions inputOptions;
    inputOptions.iso = iso_;
    inputOptions.invert = invert_;
    if (pixels_) inputOptions.pixels = *pixels_;
    curves2d::Input input = curves2d::readInput(arguments[0], inputOptions, console.progress());
    for (const std::string& remark : input.remarks) console.say(remark);
    CurvesReport report;
    report.path = arguments[0].string();
    report.kind = input.kind;
    report.pixel = input.pixel;
    report.hold = hold_;
    LevelWriter writer(draw_, curves2d::viewOf(input), out);
    report.ladder = curves2d::makeLadder(
        std::move(input), ladderOptions(), [&](const curves2d::LadderStep& step) { writer.visit(step); },
        console.progress());
    for (const std::string& remark : fitRemarks(report.ladder.fitReport)) console.say(remark);
    const int last = report.ladder.steps.back().step;
    const bool isEmpty = report.ladder.steps.back().points == 0;
    const std::string end = isEmpty ? "nothing is left" : "one node is left";
    if (levels_ && last < levels_->first * kStepsPerPlaneLevel)
        throw InputError(report.path, fmt::format("ends at level {}, where {}; --levels begins at {}",
                                                  last / kStepsPerPlaneLevel, end, levels_->first));
    if (isEmpty)
        console.say(fmt::format("{}: nothing is left; the ladder ends here", curves2d::stepName(last)));
    writer.report(report.pixel, report);
    report.peakMemoryBytes = peakMemoryBytes();
    if (draw_.sheet) sheet = writer.sheet();
    return report;
}

void CurvesCommand::tellAll(const CurvesReport& report, const OutputFolder& out, Console& console) const {
    if (draw_.smooth) console.say(smoothRemark(report));
    if (jsonToStandardOutput()) return console.print(jsonOf(report));
    if (table_) console.print(table(report));
    console.print(summary(report, out.folder().string()));
}

int CurvesCommand::run(Console& console) {
    refuseContradictions();
    refuseForeignOptions();
    OutputFolder out(*output_, Inputs(arguments));
    if (jsonToFile()) out.keepFree(*json_);
    if (draw_.sheet) out.keepFree(*draw_.sheet);
    std::optional<OutputFile> copyFolders;
    std::optional<AtomicFile> copy;  // opened now: a place that cannot be written is found before the work
    if (jsonToFile()) {
        copyFolders.emplace(*json_);
        copy.emplace(*json_);
    }

    std::string sheetText;
    const CurvesReport report = climb(out, console, sheetText);
    // What can fail for want of room comes first; then only names change.
    std::optional<OutputFile> sheetPlace;
    std::optional<AtomicFile> sheet;
    if (draw_.sheet) {
        sheetPlace.emplace(*draw_.sheet);
        sheet.emplace(*draw_.sheet);
        writeWhole(*sheet, sheetText);
    }
    if (copy) writeWhole(*copy, jsonOf(report));
    out.commit();
    if (sheet) {
        sheet->commit();
        sheetPlace->commit();
    }
    if (copy) copy->commit();
    if (copyFolders) copyFolders->commit();
    tellAll(report, out, console);
    return 0;
}

}  // namespace

std::unique_ptr<Command> curvesCommand() { return std::make_unique<CurvesCommand>(); }

}  // namespace isowave::tools
