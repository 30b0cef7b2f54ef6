// isowave rebuild BASE --details FILE -o OUT: a base and its details -> the mesh, the curves or the heights at any level,
// edited or simplified.
#include <fmt/format.h>

#include "isowave/error.h"
#include "isowave/subdivision.h"
#include "subdivision/meshes/hierarchy_report.h"
#include "subdivision/meshes/mesh_files.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/hierarchy.h"
#include "tools/subdivision/mesh_options.h"
#include "tools/subdivision/rebuild_levels.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

// Reads a mesh that must have the base's connectivity.
PolygonMesh readLikeBase(const std::filesystem::path& path, const Hierarchy& hierarchy) {
    PolygonMesh mesh = readPolygonMesh(path);
    requireManifold(mesh, path.string());
    try {
        requireSameConnectivity(hierarchy.base, mesh);
    } catch (const InputError& error) {
        throw InputError(path.string(), error.what());
    }
    if (isBaseAtLimit(hierarchy, mesh))
        throw InputError(path.string(),
                         "its vertices are at their limit positions (reverse --limit), which are for looking "
                         "at; give the base as reverse writes it without --limit");
    return mesh;
}

// BASE is the base that the details were made for.
void requireBase(const std::filesystem::path& path, const std::filesystem::path& details,
                 const Hierarchy& hierarchy) {
    const auto moved = firstMovedVertex(hierarchy.base, readLikeBase(path, hierarchy));
    if (!moved) return;
    throw InputError(
        path.string(),
        fmt::format("its vertex {} lies {:.3g} away from that of the base in {}; give a base with moved "
                    "vertices as --edited",
                    moved->vertex, moved->distance, details.string()));
}

class Rebuild : public Command {
  public:
    Rebuild();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    void refuseContradictions() const;
    RebuildOptions rebuildOptions(const Hierarchy& hierarchy) const;
    int runMesh(Console& console);
    int runLevels(Console& console, DetailsOf kind);

    int depth_ = kAllLevels;
    std::optional<std::filesystem::path> details_, edited_;
    std::optional<Frames> frames_;
    std::optional<double> threshold_;
    std::optional<std::size_t> keep_;
    bool errorTable_ = false, limit_ = false;
};

Rebuild::Rebuild()
    : Command(
          {"rebuild", "BASE",
           "a base and its details -> the mesh, curves or heights at any level, edited or simplified",
           "BASE and --details FILE come from reverse; from curve-levels, where BASE is the level_K of its "
           "--depth and OUT has its format; or from relief, where BASE is level_K.npy and OUT is .npy too. "
           "--edited BASE2 is BASE with moved vertices, points or other heights: the details follow. "
           "--threshold and --keep leave short details out and measure what that costs."}) {
    declareOutput("the file of the mesh, the curves or the heights");
    declareJson();
    declareDepth(options_, "all", "how many subdivisions finer than BASE; finer details are not even read",
                 depth_);
    options_.input("--details", "the details that reverse, curve-levels or relief has written; needed",
                   details_);
    options_.input("--edited", "BASE with moved vertices or other heights, which takes its place", edited_);
    options_.value("--frames", "global|local", "global",
                   "details keep their direction in space, or turn with the surface or curve (--edited)",
                   [this](const std::string& v) {
                       frames_ = choice<Frames>(v, {{"global", Frames::global}, {"local", Frames::local}});
                   });
    options_.value("--threshold", "LEN", "", "leave out details shorter than this, in the units of BASE",
                   [this](const std::string& v) { threshold_ = lengthIn(v, "the units of BASE"); });
    options_.value("--keep", "N", "", "only the N longest details; of each curve",
                   [this](const std::string& v) { keep_ = static_cast<std::size_t>(integer(v, 0, kHuge)); });
    options_.flag("--error-table", "meshes: the error that is left with the longest 0 to 50 % of the details",
                  errorTable_);
    options_.flag("--limit",
                  "write the result at its limit positions, on the surface or curve that it controls: for "
                  "pictures; BASE "
                  "and --edited are control positions",
                  limit_);
    declareTalk();
}

void Rebuild::refuseContradictions() const {
    if (!details_)
        throw UsageError(
            "--details: is needed; isowave reverse, curve-levels and relief write it with --details FILE");
    if (frames_ && !edited_) throw UsageError("--frames: belongs to --edited");
    if (threshold_ && keep_) throw UsageError("--threshold and --keep: give one of them");
}

RebuildOptions Rebuild::rebuildOptions(const Hierarchy& hierarchy) const {
    RebuildOptions options;
    if (edited_) options.moved = readLikeBase(*edited_, hierarchy).points;
    options.frames = frames_.value_or(options.frames);
    options.threshold = threshold_;
    options.keep = keep_;
    options.positions = positionsOf(limit_);
    options.shares = errorTable_;
    return options;
}

int Rebuild::runLevels(Console& console, DetailsOf kind) {
    if (errorTable_) throw UsageError("--error-table: is of meshes; leave it out");
    openJson();
    LevelsRebuild wanted{arguments[0], *details_, *output_,           edited_, frames_, depth_,
                         threshold_,   keep_,     positionsOf(limit_)};
    const auto [bytes, report] = kind == DetailsOf::curves ? rebuildCurves(wanted) : rebuildHeights(wanted);
    ResultFile out(*output_);
    out.write(bytes);
    readyToTell(console, jsonOf(report));
    out.commit();
    tell(console, textOf(report), jsonOf(report));
    return 0;
}

int Rebuild::run(Console& console) {
    refuseContradictions();
    const DetailsOf kind = detailsOf(*details_);
    return kind == DetailsOf::meshes ? runMesh(console) : runLevels(console, kind);
}

int Rebuild::runMesh(Console& console) {
    Hierarchy hierarchy = loadHierarchy(*details_, depth_);  // first: it is what says that a mesh is meant
    requireMeshName(*output_);
    openJson();
    requireBase(arguments[0], *details_, hierarchy);
    const RebuildOptions options = rebuildOptions(hierarchy);
    const auto [mesh, report] = [&] {
        try {
            return rebuild(std::move(hierarchy), options, console.progress());
        } catch (const InputError& error) {
            throw InputError(details_->string(), error.what());
        }
    }();

    OutputFile out(*output_);
    readyToTell(console, jsonOf(report));
    writePolygonMesh(*output_, mesh);
    out.commit();
    tell(console, textOf(report), jsonOf(report));
    return 0;
}

}  // namespace

std::unique_ptr<Command> rebuildCommand() { return std::make_unique<Rebuild>(); }

}  // namespace isowave::tools
