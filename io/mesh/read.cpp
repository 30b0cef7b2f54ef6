#include "io/mesh/read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/read_file.h"
#include "io/mesh/lines.h"
#include "io/mesh/obj.h"
#include "io/mesh/off.h"
#include "io/mesh/ply.h"
#include "io/mesh/stl.h"
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
    // Numbers in [2^e, 2^(e+1)) lie 2^(e-23) apart in float32, 2^(e-52) in float64.
    const double step = std::ldexp(1.0, std::ilogb(std::max(largest, 1e-300)) - (float32 ? 23 : 52));
    if (extent < kFewestSteps * step)
        throw InputError(
            name, fmt::format("coordinates of {:g}, where {} has steps of {:.2g}, on a part {:g} across: "
                              "fewer than {} steps are left; move it to the origin and export again",
                              largest, float32 ? "float32" : "float64", step, extent, kFewestSteps));
}

TriangleMesh inFans(PolygonSoup&& soup) {
    TriangleMesh mesh;
    mesh.points = std::move(soup.points);
    mesh.triangles.reserve(soup.corners.size() - 2 * soup.faceCount());
    for (std::size_t f = 0; f < soup.faceCount(); ++f) {
        const std::uint32_t* corner = soup.corners.data() + soup.faceBegin[f];
        for (std::size_t i = 2; i < soup.faceSize(f); ++i)
            mesh.triangles.push_back({corner[0], corner[i - 1], corner[i]});
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
        default:
            return readPly(bytes, name);
    }
}

bool isMeshPath(const std::filesystem::path& path) {
    const std::string extension = lowerCase(path.extension().string());
    return extension == ".stl" || extension == ".obj" || extension == ".ply" || extension == ".off";
}

TriangleMesh readMesh(const std::filesystem::path& path, MeshFileInfo* info, const Progress& progress) {
    const std::string name = path.string(), extension = lowerCase(path.extension().string());
    if (extension == ".gz") throw InputError(name, "is compressed by gzip; gunzip it first");
    if (!isMeshPath(path))
        throw InputError(name,
                         fmt::format("'{}' is no mesh format that is read: .stl .obj .ply .off", extension));
    progress("reading", 0.0);
    const std::string bytes = readFile(path, "a mesh file");
    progress("reading", 0.2);
    PolygonSoup soup = parseMesh(bytes, meshFormatOf(path), name);
    progress("reading", 0.8);
    checkFaces(name, soup);
    checkPoints(name, soup.points, soup.float32);
    if (info) *info = {soup.format, soup.space, static_cast<std::int64_t>(soup.faceCount())};
    TriangleMesh mesh = inFans(std::move(soup));
    progress("reading", 1.0);
    return mesh;
}

}  // namespace isowave
