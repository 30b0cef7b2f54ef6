// isowave curve-levels INPUT -o DIR: polylines at coarser levels, with the error of each.
#include <fmt/format.h>

#include <map>

#include "isowave/error.h"
#include "isowave/subdivision.h"
#include "subdivision/curves/curve_files.h"
#include "subdivision/curves/curve_limit.h"
#include "subdivision/curves/curve_schemes.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/curve_levels.h"
#include "tools/subdivision/filter_options.h"
#include "tools/subdivision/mesh_options.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

// level_0.EXT .. level_L.EXT, smooth.EXT (P alone on the coarsest level), and thresholded.EXT when details were dropped.
std::map<std::string, std::string> filesOf(const CurveReport& report, const CurveFile& input,
                                           const std::string& extension) {
    std::map<std::string, std::string> files;
    for (std::size_t k = 0; k < report.atLevel.size(); ++k)
        files[fmt::format("level_{}{}", k, extension)] = input.with(report.atLevel[k]);
    files["smooth" + extension] = input.with(report.smooth);
    if (!report.thresholded.empty()) files["thresholded" + extension] = input.with(report.thresholded);
    return files;
}

class CurveLevels : public Command {
  public:
    CurveLevels();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    void requireLimit() const;
    CurveReport reported(const CurveFile& file) const;

    CurveReportOptions report_;
    std::optional<std::string> scheme_, mask_;
    std::optional<int> width_;
    std::optional<std::filesystem::path> details_;
    bool limit_ = false;
};

CurveLevels::CurveLevels()
    : Command(
          {"curve-levels", "INPUT", "curves -> the same curves at coarser levels, losslessly",
           "INPUT holds polylines: .txt (a point a line), GeoJSON, SVG paths. -o out/coast makes the folder "
           "out/coast with level_0, level_1, ... in the same format, and smooth: the coarsest level "
           "subdivided back, "
           "without details. Open curves keep their ends; any number of points will do. Prints the points "
           "and the "
           "L2 error of each level."}) {
    declareOutput("the folder that gets one file a level");
    declareJson();
    options_.value("--scheme", "NAME", "dlg-refined",
                   "chaikin-W, cubic-W (W taps), dlg-trial, dlg-refined, dlg-optimal",
                   [this](const std::string& v) { scheme_ = v; });
    declareMask(options_, mask_);
    declareWidth(options_, width_);
    options_.value("--depth", "N", "6", "how many decompositions",
                   [this](const std::string& v) { report_.levels = static_cast<int>(integer(v, 0, 60)); });
    options_.value(
        "--points", "N", "as they are", "first put N points at equal steps along each curve",
        [this](const std::string& v) { report_.resample = static_cast<std::size_t>(integer(v, 2, kHuge)); });
    options_.value("--threshold", "LEN", "", "drop details shorter than this, into thresholded",
                   [this](const std::string& v) { report_.threshold = lengthIn(v, kInputUnits); });
    options_.value(
        "--keep", "N", "", "keep only the N longest details of each curve, into thresholded",
        [this](const std::string& v) { report_.keep = static_cast<std::size_t>(integer(v, 0, kHuge)); });
    options_.result(
        "--details", "FILE",
        "everything that rebuild needs to have the curves back from the coarsest level, without what "
        "--threshold and --keep drop",
        details_);
    options_.flag("--limit",
                  "write the points of every curve at their limit positions, on the curve that they control",
                  limit_);
    options_.flag("--compare-schemes", "compare the schemes' errors too", report_.compare);
    declareTalk();
}

// A mask without limit positions is not the file's fault.
void CurveLevels::requireLimit() const {
    if (!limit_ || !mask_) return;
    const CurveScheme scheme = asked("--mask", [&] { return maskScheme(*mask_, width_.value_or(0)); });
    asked("--limit", [&] { return CurveLimit(scheme); });
}

CurveReport CurveLevels::reported(const CurveFile& file) const {
    CurveReportOptions options = report_;
    options.scheme = scheme_.value_or(options.scheme);
    options.mask = mask_.value_or("");
    options.width = width_.value_or(0);
    options.positions = positionsOf(limit_);
    options.details = details_.has_value();
    try {
        return reportCurves(file.curves(), options);
    } catch (const InputError& error) {
        throw InputError(arguments[0].string(), error.what());
    }
}

int CurveLevels::run(Console& console) {
    if (mask_ && scheme_) throw UsageError("--mask: is a scheme of its own; leave --scheme out");
    if (width_ && !mask_) throw UsageError("--width: belongs to --mask; write --scheme cubic-7 otherwise");
    if (scheme_)
        asked("--scheme", [&] { return curveScheme(*scheme_); });  // a wrong name is not the file's fault
    requireLimit();
    OutputFolder out(*output_, Inputs(arguments));
    if (jsonToFile()) out.keepFree(*json_);
    if (details_) out.keepFree(*details_);
    openJson();
    std::optional<ResultFile> details;  // opened now: a place that cannot be written is found before the work
    if (details_) details.emplace(*details_);
    const CurveFile file = CurveFile::read(arguments[0]);
    const CurveReport report = reported(file);
    writeFiles(out, filesOf(report, file, arguments[0].extension().string()));
    if (details) details->write(report.details);
    for (const auto& remark : remarks(report)) console.say(remark);
    readyToTell(console, jsonOf(report));
    out.commit();
    if (details) details->commit();
    tell(console, textOf(report), jsonOf(report));
    return 0;
}

}  // namespace

std::unique_ptr<Command> curveLevelsCommand() { return std::make_unique<CurveLevels>(); }

}  // namespace isowave::tools
