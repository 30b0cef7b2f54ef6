// isowave check MESH: counts what the mesh is, repairs nothing.
#include "io/mesh/equal_points.h"
#include "lod/open_mesh.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/report/mesh_report.h"

namespace isowave::tools {
namespace {

constexpr int kExitDefective = 4;

class Check : public Command {
  public:
    Check()
        : Command(
              {"check", "MESH", "is a mesh closed, 2-manifold and oriented? components, genus, volume, area",
               "Reads the mesh as it is, merges equal points and repairs nothing. Exit code 4 when it is not "
               "closed, not 2-manifold or not oriented."}) {
        declareJson();
        options_.flag("--self-intersections", "count pairs of triangles that intersect (slow)",
                      selfIntersections_);
        declareThreads();
        declareTalk();
    }

    int run(Console& console) override {
        const lod::LoadedMesh loaded = lod::loadMesh(arguments[0], console.progress());
        const TriangleMesh mesh = mergeEqualPoints(loaded.mesh);
        CheckReport check{arguments[0].string(), loaded.format, topologyOf(mesh), {}};
        if (selfIntersections_) check.selfIntersections = countSelfIntersections(mesh, console.progress());
        tell(console, textOf(check), jsonOf(check));
        const MeshTopology& t = check.topology;
        return t.closed() && t.manifold() && t.oriented() ? 0 : kExitDefective;
    }

  private:
    bool selfIntersections_ = false;
};

}  // namespace

std::unique_ptr<Command> checkCommand() { return std::make_unique<Check>(); }

}  // namespace isowave::tools
