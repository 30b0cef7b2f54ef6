// isowave reverse MESH -o BASE: a mesh with subdivision connectivity, as a coarse base and details.
#include <sstream>

#include "isowave/error.h"
#include "isowave/subdivision.h"
#include "subdivision/meshes/hierarchy.h"
#include "subdivision/meshes/mesh_files.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/option_values.h"
#include "tools/output.h"
#include "tools/report/hierarchy.h"
#include "tools/subdivision/mesh_options.h"

namespace isowave::tools {
namespace {

using namespace subdivision;

class Reverse : public Command {
  public:
    Reverse();
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    DecomposeOptions decomposeOptions(const MeshScheme& scheme) const;
    PolygonMesh baseToWrite(const Hierarchy& hierarchy) const;
    void refuseContradictions() const;
    void write(const Hierarchy& hierarchy) const;

    int depth_ = kAllLevels;
    std::string scheme_ = "catmull-clark", variant_;
    std::optional<double> creaseAngle_;
    bool limit_ = false;
    std::optional<std::filesystem::path> details_;
    std::optional<double> threshold_;
    std::optional<std::size_t> keep_;
};

Reverse::Reverse()
    : Command(
          {"reverse", "MESH",
           "a mesh with subdivision connectivity -> a coarse base mesh and details, losslessly",
           "MESH (OBJ, OFF, PLY) is one that subdivision has made, moved points and all: catmull-clark finds "
           "the "
           "polygons inside a mesh of quads, loop and butterfly the triangles inside one of triangles; "
           "vertices and "
           "faces may come in any order. -o BASE is the coarse mesh, --details FILE everything that is "
           "needed to "
           "have MESH back. Marked creases ('t crease 2/1/0 V1 V2 SHARPNESS', vertices counted from 0) and "
           "boundaries are curves of their own."}) {
    declareOutput("the base mesh's file");
    declareJson();
    declareDepth(options_, "as many as there are", "how many levels coarser", depth_);
    declareScheme(options_, scheme_);
    options_.value("--variant", "NAME", "the first",
                   "how the coarse mesh is fitted; catmull-clark: refined, trial, unscaled, tensor, wide; "
                   "loop, butterfly: refined, trial, wide",
                   [this](const std::string& v) { variant_ = v; });
    declareCrease(options_, creaseAngle_);
    options_.flag("--limit",
                  "write BASE at its limit positions, on the surface that it controls: for pictures, not for "
                  "rebuild; --details stay those of the control positions",
                  limit_);
    options_.result("--details", "FILE", "the file that gets the details", details_);
    options_.value("--threshold", "LEN", "",
                   "leave details shorter than this, in the units of the mesh, out of the file",
                   [this](const std::string& v) { threshold_ = lengthIn(v, kInputUnits); });
    options_.value("--keep", "N", "", "only the N longest details go into the file, which is smaller then",
                   [this](const std::string& v) { keep_ = static_cast<std::size_t>(integer(v, 0, kHuge)); });
    declareTalk();
}

void Reverse::refuseContradictions() const {
    if (threshold_ && keep_) throw UsageError("--threshold and --keep: give one of them");
    if ((threshold_ || keep_) && !details_)
        throw UsageError(std::string(keep_ ? "--keep" : "--threshold") +
                         ": says what goes into the file of --details; name that too");
}

DecomposeOptions Reverse::decomposeOptions(const MeshScheme& scheme) const {
    DecomposeOptions options;
    options.variant = variantWanted(scheme, variant_);
    options.levels = depth_;
    options.creaseAngle = creaseAngle_;
    refuseCrease(creaseAngle_, scheme.name);
    return options;
}

PolygonMesh Reverse::baseToWrite(const Hierarchy& hierarchy) const {
    PolygonMesh base = hierarchy.base;
    if (limit_) base.points = limitPoints(hierarchy.base, hierarchy.scheme);
    return base;
}

// The base and, when asked for, the details: both or none.
void Reverse::write(const Hierarchy& hierarchy) const {
    ResultFile base(*output_);
    std::optional<ResultFile> details;
    if (details_) details.emplace(*details_);
    base.write(polygonMeshBytes(baseToWrite(hierarchy), polygonFormatOf(*output_)));
    if (details) {
        std::ostringstream bytes;
        writeHierarchy(bytes, hierarchy);
        details->write(bytes.str());
        details->commit();
    }
    base.commit();
}

int Reverse::run(Console& console) {
    const auto& input = arguments[0];
    refuseContradictions();
    const MeshScheme& scheme = schemeWanted(scheme_);
    const DecomposeOptions options = decomposeOptions(scheme);
    requireMeshName(*output_);
    openJson();
    const PolygonMesh mesh = readAndRemark(input, console);
    Hierarchy hierarchy = [&] {
        try {
            return decompose(mesh, scheme, options, console.progress());
        } catch (const InputError& error) {
            throw InputError(input.string(), error.what());
        }
    }();
    DecompositionReport report = reportDecomposition(hierarchy, mesh, console.progress());
    report.positions = positionsOf(limit_);
    if (threshold_ || keep_) dropDetails(hierarchy, mesh, threshold_, keep_, report, console.progress());
    if (report.roundTrip > kMeshRoundTrip * report.diagonal)
        console.say("the mesh comes back to " + std::to_string(report.roundTrip / report.diagonal) +
                    " of its diagonal only");
    if (!details_ && hierarchy.steps() > 0)
        console.say("the details are not kept; --details FILE writes them");
    readyToTell(console, jsonOf(report));
    write(hierarchy);
    tell(console, textOf(report), jsonOf(report));
    return 0;
}

}  // namespace

std::unique_ptr<Command> reverseCommand() { return std::make_unique<Reverse>(); }

}  // namespace isowave::tools
