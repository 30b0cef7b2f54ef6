// isowave subdivide MESH -o OUT: a mesh, subdivided.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/number_text.h"
#include "base/peak_memory.h"
#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"
#include "subdivision/meshes/mesh_files.h"
#include "subdivision/meshes/polygon_mesh.h"
#include "tools/commands.h"
#include "tools/console.h"
#include "tools/output.h"
#include "tools/report/hierarchy.h"
#include "tools/subdivision/mesh_options.h"

namespace isowave::tools {

namespace {

using namespace subdivision;

// Of the meshes before and after the last subdivision together. Seen: 93 and 137 for a torus of 2.4 million triangles, 1.8 million
// quadrilaterals.
constexpr double kBytesPerFace = 140;

double facesAfter(const PolygonMesh& mesh, const MeshScheme& scheme, int depth) {
    if (depth == 0) return static_cast<double>(mesh.faceCount());
    const double first = scheme.name == "catmull-clark" ? static_cast<double>(mesh.corners.size())
                                                        : 4 * static_cast<double>(mesh.faceCount());
    return first * std::pow(4.0, depth - 1);
}

// Before anything is made: each subdivision takes four times the memory of the one before.
void refuseTooManyFaces(const std::string& name, const PolygonMesh& mesh, const MeshScheme& scheme,
                        int depth) {
    const double limit = std::min(usualMemoryLimit(), kBytesPerFace * double(kNone));
    const auto bytes = [&](int d) { return kBytesPerFace * facesAfter(mesh, scheme, d); };
    if (bytes(depth) <= limit) return;
    int most = depth - 1;
    while (most > 0 && bytes(most) > limit) --most;
    throw InputError(
        name,
        fmt::format("--depth {} makes {:.3g} faces, about {} of memory, over the limit of {}; at most "
                    "--depth {} here",
                    depth, facesAfter(mesh, scheme, depth), bytesText(bytes(depth)), bytesText(limit), most));
}

// Borders that lie on each other, as where a writer gave every face points of its own: closed to the eye, and subdivision opens them.
std::size_t seamEdges(const PolygonMesh& mesh) {
    const Adjacency adjacency(mesh);
    using Place = std::array<double, 3>;
    const auto placeOf = [&](Index v) { return Place{mesh.points[v].x, mesh.points[v].y, mesh.points[v].z}; };
    std::map<std::array<Place, 2>, std::size_t> at;
    for (Index e = 0; e < adjacency.edges(); ++e) {
        if (!adjacency.isBoundaryEdge(e)) continue;
        const Index c = adjacency.edgeCorner(e);
        std::array<Place, 2> ends{placeOf(adjacency.vertex(c)), placeOf(adjacency.target(c))};
        std::sort(ends.begin(), ends.end());
        ++at[ends];
    }
    std::size_t seams = 0;
    for (const auto& [ends, edges] : at) seams += edges > 1 ? edges : 0;
    return seams;
}

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
    if (const std::size_t seams = seamEdges(mesh); seams > 0)
        console.say(fmt::format(
            "{}: {} of the border lie on each other: the surface opens there; merge equal points first",
            arguments[0].string(), counted(static_cast<std::int64_t>(seams), "edge")));
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
    refuseTooManyFaces(arguments[0].string(), before, scheme, depth_);
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
