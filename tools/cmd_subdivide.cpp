// isowave subdivide MESH -o OUT: a mesh, subdivided.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"
#include "subdivision/meshes/mesh_files.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"

namespace isowave::tools {

int runSubdivide(const Settings& settings, Console& console) {
    using namespace subdivision;
    const auto& input = settings.files[0];
    const MeshScheme& scheme = meshScheme(settings.scheme.value_or("catmull-clark"));
    const int levels = settings.depth.value_or(1);
    polygonFormatOf(*settings.output);  // a wrong name is found before the work
    PolygonMesh coarse = readPolygonMesh(input);
    requireManifold(coarse, input.string());
    if (settings.creaseAngle) {
        const auto found = creasesByAngle(coarse, Adjacency(coarse), *settings.creaseAngle);
        coarse.creases.insert(coarse.creases.end(), found.begin(), found.end());
    }
    const PolygonMesh mesh = [&] {
        try {
            return subdivided(coarse, scheme, levels, console.progress());
        } catch (const InputError& error) {
            throw InputError(input.string(), error.what());
        }
    }();
    OutputFile out(*settings.output);
    writePolygonMesh(*settings.output, mesh);
    out.commit();
    if (settings.json) {
        const nlohmann::ordered_json report = {{"version", 1},
                                               {"scheme", scheme.name},
                                               {"levels", levels},
                                               {"creases", coarse.creases.size()},
                                               {"vertices", mesh.vertexCount()},
                                               {"faces", mesh.faceCount()}};
        console.print(report.dump(1) + "\n");
    } else {
        console.print(fmt::format("{}, {} level{}: {} vertices, {} faces\n", scheme.name, levels,
                                  levels == 1 ? "" : "s", mesh.vertexCount(), mesh.faceCount()));
    }
    return 0;
}

}  // namespace isowave::tools
