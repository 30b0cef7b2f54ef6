#include "tests/fuzz/solids/written.h"

#include <algorithm>
#include <cmath>

#include "io/mesh/float32.h"
#include "io/mesh/place.h"
#include "io/mesh/read.h"
#include "io/mesh/write.h"
#include "io/mesh/xml/solid_parts.h"
#include "tests/fuzz/target.h"

namespace isowave::fuzz {
namespace {

double farthestOf(const TriangleMesh& mesh) {
    double farthest = 0;
    for (const Point& p : mesh.points)
        for (const double x : p) farthest = std::max(farthest, std::abs(x));
    return farthest;
}

// The places of the corners of all triangles, one after another.
std::vector<Point> cornersOf(const PolygonSoup& soup) {
    std::vector<Point> corners;
    for (const std::uint32_t v : soup.corners) {
        require(v < soup.points.size(), "a file that was written names a point that it has not");
        corners.push_back(soup.points[v]);
    }
    return corners;
}

std::vector<Point> cornersOf(const TriangleMesh& mesh, const std::vector<Triangle>& triangles, double scale) {
    std::vector<Point> corners;
    for (const Triangle& t : triangles)
        for (const std::uint32_t v : t) {
            Point p = mesh.points[v];
            for (double& x : p) x *= scale;
            corners.push_back(p);
        }
    return corners;
}

void requireNear(const std::vector<Point>& found, const std::vector<Point>& expected, double allowed) {
    require(found.size() == expected.size(), "triangles are lost or added when a mesh is written");
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a)
            require(std::abs(found[i][a] - expected[i][a]) <= allowed,
                    "a corner moves when a mesh is written and read again");
}

std::vector<Triangle> partByPart(const TriangleMesh& mesh) {
    std::vector<Triangle> all;
    for (const auto& part : solidParts(mesh.points, mesh.triangles))
        all.insert(all.end(), part.begin(), part.end());
    require(all.size() == mesh.triangles.size(), "the parts of a mesh are not all of it");
    return all;
}

PolygonSoup again(const MeshView& view, MeshFormat format, const char* name) {
    Sink sink;
    printMesh(sink, view, format, name);
    PolygonSoup soup = parseMesh(sink.take(), format, name);
    for (std::size_t f = 0; f < soup.faceCount(); ++f)
        require(soup.faceSize(f) == 3, "a triangle is read again as something else");
    return soup;
}

void requireSpace(const PolygonSoup& soup, Space space) {
    const char* const expected = space == Space::lps ? "LPS" : space == Space::ras ? "RAS" : "";
    require(soup.space == expected, "a file that was written names another space");
}

}  // namespace

Writing::Writing(Bytes& bytes) {
    constexpr double kUnits[] = {0.001, 1e-6, 0.01, 1, 0.0254, 0.3048, 0.00123};
    constexpr Space kSpaces[] = {Space::unspecified, Space::lps, Space::ras};
    space = kSpaces[bytes.between(0, 2)];
    metresPerUnit = kUnits[bytes.between(0, 6)];
    farthest = static_cast<float>(bytes.between(0, 3)) * 0.7F;
}

void requireWritten(const TriangleMesh& mesh, const Writing& how) {
    if (mesh.triangles.empty()) return;
    std::vector<float> distances;
    if (how.farthest > 0)
        for (std::size_t i = 0; i < mesh.points.size(); ++i)
            distances.push_back(how.farthest * static_cast<float>(i % 7) / 6);
    MeshView view;
    view.points = mesh.points;
    view.normals = mesh.normals;
    view.triangles = mesh.triangles;
    view.space = how.space;
    view.distances = distances;
    view.metresPerUnit = how.metresPerUnit;
    constexpr double kHalfStep = 1.0 / (1 << 24), kMillimetres = 1000;
    const double far = farthestOf(mesh), rounded = needsFloat64(view) ? 0 : kHalfStep * far;

    const PolygonSoup vtp = again(view, MeshFormat::vtp, "mesh.vtp");
    requireNear(cornersOf(vtp), cornersOf(mesh, mesh.triangles, 1), rounded);
    requireSpace(vtp, how.space);

    // Millimetres, by one or two products that round.
    const double scale = kMillimetres * how.metresPerUnit;
    const PolygonSoup threeMf = again(view, MeshFormat::threeMf, "mesh.3mf");
    requireNear(cornersOf(threeMf), cornersOf(mesh, partByPart(mesh), scale),
                scale * (rounded + kHalfStep * far));
    requireSpace(threeMf, how.space);

    // Placed as it is, Y up and in metres; the reader turns it back. Points of one float32 triple are moved apart.
    constexpr double kApart = 4;
    TriangleMesh placed{mesh.points, mesh.triangles, mesh.normals};
    placeFor(MeshFormat::glb, {Space::unspecified, how.metresPerUnit}, placed);
    view.points = placed.points;
    view.normals = placed.normals;
    requireNear(cornersOf(again(view, MeshFormat::glb, "mesh.glb")), cornersOf(mesh, mesh.triangles, scale),
                scale * far * kHalfStep * 2 * (1 + kApart));
}

}  // namespace isowave::fuzz
