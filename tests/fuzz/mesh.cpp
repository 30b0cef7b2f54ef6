#include "tests/fuzz/mesh.h"

#include <cmath>

#include "io/mesh/read.h"
#include "subdivision/meshes/mesh_files.h"

namespace isowave::fuzz {
namespace {

void check(const MeshFile& file) {
    require(!file.mesh.triangles.empty(), "a mesh without triangles was read");
    for (const Point& p : file.mesh.points)
        for (const double x : p) require(std::isfinite(x), "a coordinate that is not finite was read");
    for (const Triangle& t : file.mesh.triangles)
        for (const std::uint32_t corner : t)
            require(corner < file.mesh.points.size(), "a corner beyond the points was read");
    require(std::isfinite(file.step) && file.step >= 0, "a step of coordinates that is no length");
}

bool hasPolygons(MeshFormat format) {
    return format == MeshFormat::obj || format == MeshFormat::off || format == MeshFormat::ply;
}

// REQUIRES: all corners name points.
void checkRoundTrip(const subdivision::PolygonMesh& mesh, MeshFormat format) {
    const std::string bytes = subdivision::polygonMeshBytes(mesh, format);
    const auto again = subdivision::parsePolygonMesh(bytes, format, "again");
    require(again.points == mesh.points, "points change when they are written and read again");
    require(again.corners == mesh.corners && again.faceBegin == mesh.faceBegin,
            "faces change when they are written and read again");
}

void readPolygons(std::string_view bytes, MeshFormat format) {
    const auto mesh = subdivision::parsePolygonMesh(bytes, format, "polygons");
    const auto named = [&](std::uint32_t corner) { return corner < mesh.points.size(); };
    const bool sound = std::all_of(mesh.corners.begin(), mesh.corners.end(), named);
    const auto finite = [](const Vec3& p) { return std::isfinite(p.x + p.y + p.z); };
    if (sound && !mesh.corners.empty() && std::all_of(mesh.points.begin(), mesh.points.end(), finite))
        checkRoundTrip(mesh, format);
}

Answer read(std::string_view bytes, MeshFormat format) {
    if (hasPolygons(format)) answerOf("polygons", [&] { readPolygons(bytes, format); });
    const auto path = fileOf(bytes, std::string("mesh") + extensionOf(format));
    return answerOf(path.string(), [&] { check(readMeshFile(path)); });
}

}  // namespace

std::vector<Target> meshTargets() {
    std::vector<Target> targets;
    for (const MeshFormat format :
         {MeshFormat::stl, MeshFormat::off, MeshFormat::obj, MeshFormat::ply, MeshFormat::glb})
        targets.push_back(
            {extensionOf(format) + 1, [format](std::string_view bytes) { return read(bytes, format); }});
    for (const char* extension : {"vtp", "3mf"})
        targets.push_back({extension, [extension](std::string_view bytes) {
                               const auto path = fileOf(bytes, std::string("mesh.") + extension);
                               return answerOf(path.string(), [&] { check(readMeshFile(path)); });
                           }});
    return targets;
}

}  // namespace isowave::fuzz
