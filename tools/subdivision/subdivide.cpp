// isowave subdivide MESH -o OUT: a mesh, subdivided.
#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"
#include "subdivision/meshes/mesh_files.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/report/hierarchy.h"
#include "tools/subdivision/mesh_options.h"

namespace isowave::tools {

namespace {

using namespace subdivision;

class Subdivide : public Command {
  public:
    Subdivide()
        : Command({"subdivide", "MESH",
                   "a polygon mesh -> the same, subdivided by Catmull-Clark, Loop or Butterfly",
                   "MESH is OBJ, OFF or PLY; so is the output, by its name."}) {
        declareOutput("the mesh's file");
        declareJson();
        declareDepth(options_, "1", "how many subdivisions", depth_);
        declareScheme(options_, scheme_);
        declareCrease(options_, creaseAngle_);
        options_.flag("--limit",
                      "write the vertices at their limit positions, where more subdivisions would take them",
                      limit_);
        declareTalk();
    }
    bool needsOutput() const override { return true; }
    int run(Console& console) override;

  private:
    PolygonMesh coarse(Console& console) const;

    int depth_ = 1;
    std::string scheme_ = "catmull-clark";
    std::optional<double> creaseAngle_;
    bool limit_ = false;
};

PolygonMesh Subdivide::coarse(Console& console) const {
    PolygonMesh mesh = readAndRemark(arguments[0], console);
    requireManifold(mesh, arguments[0].string());
    if (creaseAngle_) {
        const auto found = creasesByAngle(mesh, Adjacency(mesh), *creaseAngle_);
        mesh.creases.insert(mesh.creases.end(), found.begin(), found.end());
    }
    return mesh;
}

int Subdivide::run(Console& console) {
    const MeshScheme& scheme = schemeWanted(scheme_);
    refuseCrease(creaseAngle_, scheme.name);
    requireMeshName(*output_);
    openJson();
    const PolygonMesh before = coarse(console);
    const PolygonMesh mesh = [&] {
        try {
            PolygonMesh fine = subdivided(before, scheme, depth_, console.progress());
            if (limit_) fine.points = limitPoints(fine, scheme);
            return fine;
        } catch (const InputError& error) {
            throw InputError(arguments[0].string(), error.what());
        }
    }();
    const SubdivisionReport report{std::string(scheme.name), depth_,           before.creases.size(),
                                   mesh.vertexCount(),       mesh.faceCount(), positionsOf(limit_)};
    OutputFile out(*output_);
    readyToTell(console, jsonOf(report));
    writePolygonMesh(*output_, mesh);
    out.commit();
    tell(console, textOf(report), jsonOf(report));
    return 0;
}

}  // namespace

std::unique_ptr<Command> subdivideCommand() { return std::make_unique<Subdivide>(); }

}  // namespace isowave::tools
