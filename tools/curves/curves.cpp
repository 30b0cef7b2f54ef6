// isowave curves INPUT -o FOLDER: bitmap or polygons -> the curves of every step as it passes by; one file a level, put
// into the folder at once at the end, and on request a table, a sheet and a report.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/peak_memory.h"
#include "curves2d/draw.h"
#include "isowave/curves.h"
#include "isowave/error.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/curves/curve_options.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/curves.h"
#include "tools/report/json.h"

namespace isowave::tools {
namespace {

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

// How the curves are written.
struct DrawOptions {
    CurveFormat format = CurveFormat::svg;
    curves2d::DrawOptions curves;
    std::optional<std::filesystem::path> sheet;
};

// Writes the wanted steps and keeps what the report and the sheet hold.
class LevelWriter {
  public:
    LevelWriter(const CurveOptions& options, const DrawOptions& draw, const curves2d::View& view,
                OutputFolder& out)
        : options_(options), draw_(draw), view_(view), out_(out) {}

    void visit(const curves2d::LadderStep& step) {
        std::optional<std::string> file;
        if (options_.isWanted(step) && !step.curves().rings.empty()) {
            file = fmt::format("{}_{}{}", out_.name(), step.name(), extensionOf(draw_.format));
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
        report.smooth = draw_.curves.smooth;
        report.deviation = deviation_ / pixel;
        report.straightPieces = straightPieces_;
    }

  private:
    void write(const std::string& name, const curves2d::LadderStep& step) {
        const std::filesystem::path place = out_.place(name);
        ++files_;
        const auto [curves, smooth] = step.drawn(draw_.curves);
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

    const CurveOptions& options_;
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
    void refuseContradictions() const;
    CurvesReport climb(OutputFolder& out, ResultFile* pyramid, Console& console, std::string& sheet) const;
    void tellAll(const CurvesReport& report, const OutputFolder& out, Console& console) const;

    CurveOptions curves_;
    DrawOptions draw_;
    bool table_ = false;
};

CurvesCommand::CurvesCommand()
    : Command({"curves", "INPUT", "a bitmap or polygons -> a ladder of closed planar curves, one a level",
               "INPUT is an image (PNG, TIFF, BMP, PGM, PBM), polygons (GeoJSON, TopoJSON, text with rings "
               "as lines 'x y') or a pyramid (.iwc, by --pyramid). -o out/africa makes the folder out/africa "
               "with africa_L0.svg, africa_L1.svg, ...; a "
               "level at "
               "which nothing is left has no file. Level L is step 2L: both axes halved L times. Outer rings "
               "have "
               "positive area, holes negative, in the input's own coordinates."}) {
    declareOutput("the folder that gets one file a level");
    curves_.declareLevels(options_);
    declareDrawing();
    declareJson();
    curves_.declareInput(options_);
    curves_.declareFit(options_);
    curves_.declareEdits(options_);
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
    curves_.declareDrawing(options_);
    options_.flag("--table", "print a table of the steps: domain, control points, nodes, rings, area",
                  table_);
    options_.result("--sheet", "FILE", "one SVG with all levels side by side", draw_.sheet);
    curves_.declarePyramid(options_);
}

void CurvesCommand::refuseContradictions() const {
    if (curves_.draw.smooth && draw_.format != CurveFormat::svg)
        throw UsageError("--smooth writes Bezier curves, which only --format svg has");
    curves_.ladder();
    curves_.refuseForeign(arguments[0].string(), curveInputOf(arguments[0]));
}

// Climbs the ladder, writes the levels into `out`, and says what came of it.
CurvesReport CurvesCommand::climb(OutputFolder& out, ResultFile* pyramid, Console& console,
                                  std::string& sheet) const {
    curves2d::Input input = curves2d::readInput(arguments[0], curves_.input(), console.progress());
    for (const std::string& remark : input.remarks) console.say(remark);
    for (const std::string& remark : curves_.remarks()) console.say(remark);
    input = curves_.prepared(std::move(input), console.progress());
    if (pyramid) pyramid->write(curves2d::pyramidBytes(input));
    CurvesReport report;
    report.path = arguments[0].string();
    report.kind = input.kind;
    report.pixel = input.pixel;
    report.hold = curves_.hold;
    DrawOptions draw = draw_;
    draw.curves = curves_.draw;
    LevelWriter writer(curves_, draw, curves2d::viewOf(input), out);
    report.ladder = curves2d::makeLadder(
        std::move(input), curves_.ladder(), [&](const curves2d::LadderStep& step) { writer.visit(step); },
        console.progress());
    for (const std::string& remark : fitRemarks(report.ladder.fitReport)) console.say(remark);
    requireFirstLevel(curves_, report.ladder, report.path);
    const int last = report.ladder.steps.back().step;
    const bool isEmpty = report.ladder.steps.back().points == 0;
    if (isEmpty)
        console.say(fmt::format("{}: nothing is left; the ladder ends here", curves2d::stepName(last)));
    writer.report(report.pixel, report);
    report.peakMemoryBytes = peakMemoryBytes();
    if (draw_.sheet) sheet = writer.sheet();
    return report;
}

void CurvesCommand::tellAll(const CurvesReport& report, const OutputFolder& out, Console& console) const {
    if (jsonToStandardOutput()) return console.print(withRemarks(jsonOf(report), console.remarks()));
    if (table_) console.print(table(report));
    console.print(summary(report, out.folder().string()));
}

int CurvesCommand::run(Console& console) {
    refuseContradictions();
    const Inputs inputs(curves_.inputs(arguments[0]));
    for (const auto& place : options_.results()) inputs.refuse(place);
    OutputFolder out(*output_, inputs);
    if (jsonToFile()) out.keepFree(*json_);
    for (const auto& place : {draw_.sheet, curves_.pyramid})
        if (place) out.keepFree(*place);
    // Opened now: a place that cannot be written is found before the work.
    std::optional<ResultFile> copy, pyramid, sheet;
    if (jsonToFile()) copy.emplace(*json_);
    if (curves_.pyramid) pyramid.emplace(*curves_.pyramid);

    std::string sheetText;
    const CurvesReport report = climb(out, pyramid ? &*pyramid : nullptr, console, sheetText);
    // What can fail for want of room comes first; then only names change.
    if (draw_.sheet) sheet.emplace(*draw_.sheet);
    if (sheet) sheet->write(sheetText);
    if (curves_.draw.smooth) console.say(smoothRemark(report));
    if (copy) copy->write(withRemarks(jsonOf(report), console.remarks()));
    out.commit();
    for (auto* beside : {&sheet, &pyramid, &copy})
        if (*beside) (*beside)->commit();
    tellAll(report, out, console);
    return 0;
}

}  // namespace

std::unique_ptr<Command> curvesCommand() { return std::make_unique<CurvesCommand>(); }

}  // namespace isowave::tools
