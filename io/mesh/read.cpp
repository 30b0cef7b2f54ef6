#include "io/mesh/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/cad_model.h"
#include "base/inflate.h"
#include "base/polygon_triangles.h"
#include "base/read_file.h"
#include "io/mesh/glb_reader.h"
#include "io/mesh/lines.h"
#include "io/mesh/obj.h"
#include "io/mesh/off.h"
#include "io/mesh/ply.h"
#include "io/mesh/stl.h"
#include "io/mesh/xml/three_mf.h"
#include "io/mesh/xml/vtp.h"
#include "isowave/error.h"

namespace isowave {
namespace {

// Polygons that are no polygons, or refer to points that the file does not hold.
void checkFaces(const std::string& name, const PolygonSoup& soup) {
    if (soup.faceCount() == 0) throw InputError(name, "no triangles");
    if (std::max(soup.points.size(), soup.corners.size()) > std::numeric_limits<std::uint32_t>::max())
        throw InputError(name, "more than 2^32 points or corners; split the mesh");
    for (std::size_t f = 0; f < soup.faceCount(); ++f) {
        if (soup.faceSize(f) < 3)
            throw InputError(
                name, fmt::format("face {} has {} corners; at least 3 are needed", f + 1, soup.faceSize(f)));
        for (std::size_t c = soup.faceBegin[f]; c < soup.faceBegin[f + 1]; ++c)
            if (soup.corners[c] >= soup.points.size())
                throw InputError(
                    name, fmt::format("face {} refers to a point that is missing; the file has {} points",
                                      f + 1, soup.points.size()));
    }
}

void checkCoordinate(const std::string& name, std::size_t point, char axis, double x) {
    if (!std::isfinite(x))
        throw InputError(name, fmt::format("point {}: {} = {} is not finite", point + 1, axis, x));
    if (std::abs(x) > 1e15)
        throw InputError(name, fmt::format("point {}: {} = {:g}; beyond 1e15 it is no length: damaged, "
                                           "or written in another byte order",
                                           point + 1, axis, x));
}

void checkPoints(const std::string& name, const std::vector<Point>& points, bool float32) {
    double largest = 0, extent = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double x = points[i][axis];
            checkCoordinate(name, i, "xyz"[axis], x);
            low = std::min(low, x);
            high = std::max(high, x);
        }
        largest = std::max({largest, high, -low});
        extent = std::max(extent, high - low);
    }
    if (!(extent > 0) && !(largest > 0))
        throw InputError(name, "all its points are (0, 0, 0); expected a solid with an extent");
    // Numbers in [2^e, 2^(e+1)) lie 2^(e-23) apart in float32, 2^(e-52) in float64.
    const double step = std::ldexp(1.0, std::ilogb(std::max(largest, 1e-300)) - (float32 ? 23 : 52));
    if (extent < kFewestSteps * step)
        throw InputError(
            name, fmt::format("coordinates of {:g}, where {} has steps of {:.2g}, on a part {:g} across: "
                              "fewer than {} steps are left; move it to the origin and export again",
                              largest, float32 ? "float32" : "float64", step, extent, kFewestSteps));
}

// Of the format's numbers at the largest coordinate. A text's last digit is a unit of 10^(whole digits - digits).
double stepOf(const PolygonSoup& soup) {
    double largest = 0;
    for (const Point& p : soup.points)
        for (const double x : p) largest = std::max(largest, std::abs(x));
    if (!(largest > 0)) return 0;
    const double binary = std::ldexp(1.0, std::ilogb(largest) - (soup.float32 ? 23 : 52));
    if (soup.digits == 0) return binary;
    return std::max(binary, std::pow(10.0, std::floor(std::log10(largest)) + 1 - soup.digits));
}

TriangleMesh inTriangles(PolygonSoup&& soup) {
    TriangleMesh mesh;
    mesh.points = std::move(soup.points);
    mesh.triangles.reserve(soup.corners.size() - 2 * soup.faceCount());
    std::vector<Point> polygon;
    for (std::size_t f = 0; f < soup.faceCount(); ++f) {
        const std::uint32_t* corner = soup.corners.data() + soup.faceBegin[f];
        if (soup.faceSize(f) == 3) {
            mesh.triangles.push_back({corner[0], corner[1], corner[2]});
            continue;
        }
        polygon.clear();
        for (std::size_t i = 0; i < soup.faceSize(f); ++i) polygon.push_back(mesh.points[corner[i]]);
        for (const auto& [a, b, c] : trianglesOf(polygon))
            mesh.triangles.push_back({corner[a], corner[b], corner[c]});
    }
    return mesh;
}

}  // namespace

PolygonSoup parseMesh(std::string_view bytes, MeshFormat format, const std::string& name) {
    switch (format) {
        case MeshFormat::stl:
            return readStl(bytes, name);
        case MeshFormat::obj:
            return readObj(bytes, name);
        case MeshFormat::off:
            return readOff(bytes, name);
        case MeshFormat::glb:
            return readGlb(bytes, name);
        case MeshFormat::vtp:
            return readVtp(bytes, name);
        case MeshFormat::threeMf:
            return readThreeMf(bytes, name);
        case MeshFormat::ply:
            break;
    }
    return readPly(bytes, name);
}

std::string adviceFor(const std::filesystem::path& path) {
    if (const auto text = cadModelText(path)) return *text;
    const std::string extension = lowerCase(path.extension().string());
    constexpr std::string_view kTo = "export it as STL, OBJ, PLY, OFF or GLB";
    constexpr struct {
        std::string_view extension, what, from;
    } kOthers[] = {
        {".amf", "an AMF file", "in a slicer"},
        {".gltf", "glTF with its data beside it", "as one GLB file: gltf-transform copy a.gltf a.glb, or"},
        {".scad", "an OpenSCAD program", "in OpenSCAD"},
        {".fbx", "an FBX scene", "in Blender"},
        {".dae", "a Collada scene", "in Blender"},
        {".blend", "a Blender document", "in Blender"},
        {".3ds", "a 3D Studio scene", "in Blender"},
        {".x3d", "an X3D scene", "in Blender or MeshLab"},
        {".wrl", "a VRML scene", "in Blender or MeshLab"},
        {".usdz", "a USD scene", "in Blender"},
        {".vtk", "a VTK file", "in ParaView or with meshio"},
        {".msh", "a Gmsh mesh", "with gmsh or meshio"}};
    for (const auto& other : kOthers)
        if (extension == other.extension)
            return fmt::format("is {}, which is not read; {} {}", other.what, kTo, other.from);
    return {};
}

namespace {

struct ReadFormat {
    std::string_view extension, name;
};
constexpr ReadFormat kRead[] = {{".stl", "STL"}, {".obj", "OBJ"}, {".ply", "PLY"}, {".off", "OFF"},
                                {".glb", "GLB"}, {".vtp", "VTP"}, {".3mf", "3MF"}};

// The formats' names or extensions, with `between` between them.
std::string allRead(std::string_view ReadFormat::*what, const char* between) {
    std::string all;
    for (const ReadFormat& format : kRead) all += (all.empty() ? "" : between) + std::string(format.*what);
    return all;
}

}  // namespace

std::string meshInputNames() { return allRead(&ReadFormat::name, ", "); }

bool isMeshPath(const std::filesystem::path& path) {
    const std::string extension = lowerCase(withoutGz(path).extension().string());
    return std::any_of(std::begin(kRead), std::end(kRead),
                       [&](const ReadFormat& format) { return format.extension == extension; });
}

MeshFile readMeshFile(const std::filesystem::path& path, const Progress& progress, double mostBytes) {
    const std::filesystem::path plain = withoutGz(path);
    const std::string name = path.string(), extension = lowerCase(plain.extension().string());
    if (const auto text = cadModelText(path)) throw InputError(name, *text);
    if (!isMeshPath(path)) {
        const std::string advice = adviceFor(plain);
        throw InputError(
            name, advice.empty()
                      ? fmt::format("'{}' is no mesh format that is read: .stl .obj .ply .off .glb .vtp .3mf",
                                    extension)
                      : advice);
    }
    progress("reading", 0.0);
    const std::string bytes = readInflatedFile(path, "a mesh file", mostBytes);
    progress("reading", 0.2);
    PolygonSoup soup = parseMesh(bytes, meshFormatOf(plain), name);
    progress("reading", 0.8);
    checkFaces(name, soup);
    checkPoints(name, soup.points, soup.float32);
    MeshFile file;
    file.info = {soup.format, soup.space, static_cast<std::int64_t>(soup.faceCount())};
    file.step = stepOf(soup);
    file.droppedNote = soup.droppedNote();
    file.mesh = inTriangles(std::move(soup));
    progress("reading", 1.0);
    return file;
}

TriangleMesh readMesh(const std::filesystem::path& path, MeshFileInfo* info, const Progress& progress) {
    MeshFile file = readMeshFile(path, progress);
    if (info) *info = file.info;
    return std::move(file.mesh);
}

}  // namespace isowave
