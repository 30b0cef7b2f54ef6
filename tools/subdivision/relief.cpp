// isowave relief INPUT -o DIR: a height field at coarser levels of a triangular subdivision.
#include <fmt/format.h>

#include <map>

#include "isowave/error.h"
#include "isowave/subdivision.h"
#include "subdivision/lattice/grid_files.h"
#include "subdivision/lattice/surface.h"
#include "subdivision/lattice/surface_limit.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/relief.h"
#include "tools/subdivision/mesh_options.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

// Grids as .npy, pictures as .png; reconstructed.npy is level 0.
std::map<std::string, std::string> filesOf(const ReliefReport& report) {
    std::map<std::string, std::string> files;
    for (std::size_t k = 0; k < report.levels.size(); ++k)
        files[fmt::format("level_{}.npy", k)] = npyBytes(report.levels[k].heights);
    files["reconstructed.npy"] = npyBytes(report.reconstructed);
    files["suppressed.npy"] = npyBytes(report.suppressed);
    forEachPicture(report, [&](const std::string& name, const Grid& values, double black, double white) {
        files[name + ".png"] = pngBytes(values, black, white);
    });
    return files;
}

class Relief : public Command {
  public:
    Relief();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    ReliefReportOptions report_;
    std::optional<std::string> scheme_;
    std::optional<std::filesystem::path> details_;
    bool limit_ = false;
};

Relief::Relief()
    : Command({"relief", "INPUT", "a height field -> coarser levels on the triangular lattice, losslessly",
               "INPUT is a picture (PNG, TIFF), a NumPy array (.npy) or an ESRI ASCII grid (.asc). -o "
               "out/relief makes "
               "the folder out/relief with level_K.npy and .png, shade_K.png (lit), details_K.png, "
               "suppressed.npy and "
               ".png (the coarsest level subdivided back, without details) and reconstructed.npy."}) {
    declareOutput("the folder that gets the levels");
    declareJson();
    options_.value("--scheme", "NAME", "butterfly-3",
                   "butterfly-trivial, butterfly-W, loop-W (W rings), loop-like:ALPHA,GAMMA",
                   [this](const std::string& v) { scheme_ = v; });
    options_.value("--depth", "N", "2", "how many decompositions",
                   [this](const std::string& v) { report_.levels = static_cast<int>(integer(v, 0, 20)); });
    options_.value("--layout", "rows|quincunx", "rows",
                   "every sample, one diagonal of each square an edge; or every second one, in a hexagon",
                   [this](const std::string& v) {
                       report_.layout = choice<ReliefLayout>(
                           v, {{"rows", ReliefLayout::Rows}, {"quincunx", ReliefLayout::Quincunx}});
                   });
    options_.result("--details", "FILE",
                    "everything that rebuild needs to have the heights back from the coarsest level",
                    details_);
    options_.flag("--limit",
                  "write levels and suppressed at their limit positions, on the surface that each controls; "
                  "reconstructed stays",
                  limit_);
    options_.flag("--compare-schemes", "compare the schemes' errors too", report_.compare);
    declareTalk();
}

int Relief::run(Console& console) {
    if (scheme_)
        asked("--scheme", [&] { return surfaceScheme(*scheme_); });  // a wrong name is not the file's fault
    report_.scheme = scheme_.value_or(report_.scheme);
    report_.positions = positionsOf(limit_);
    if (limit_) asked("--limit", [&] { return SurfaceLimit(surfaceScheme(report_.scheme)); });
    report_.details = details_.has_value();
    OutputFolder out(*output_, Inputs(arguments));
    if (jsonToFile()) out.keepFree(*json_);
    if (details_) out.keepFree(*details_);
    openJson();
    std::optional<ResultFile> details;  // opened now: a place that cannot be written is found before the work
    if (details_) details.emplace(*details_);
    const auto& input = arguments[0];
    const Grid grid = readGrid(input);
    const ReliefReport report = [&] {
        try {
            return reportRelief(grid, report_);
        } catch (const InputError& error) {
            throw InputError(input.string(), error.what());
        }
    }();
    if (report_.layout == ReliefLayout::Quincunx)
        console.say(fmt::format("quincunx takes {} of {} x {} samples, the largest hexagon in the middle",
                                report.levels.front().patch, grid.rows, grid.columns));
    writeFiles(out, filesOf(report));
    if (details) details->write(report.details);
    readyToTell(console, jsonOf(report));
    out.commit();
    if (details) details->commit();
    tell(console, textOf(report), jsonOf(report));
    return 0;
}

}  // namespace

std::unique_ptr<Command> reliefCommand() { return std::make_unique<Relief>(); }

}  // namespace isowave::tools
