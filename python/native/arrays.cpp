#include "python/native/arrays.h"

#include <fmt/format.h>

#include <cmath>

#include "isowave/error.h"

namespace isowave::python {
namespace {

void requireFinite(const std::vector<Point>& points, const std::string& name) {
    for (std::size_t i = 0; i < points.size(); ++i)
        for (const double x : points[i])
            if (!std::isfinite(x))
                throw InputError(name, fmt::format("point {} ({}, {}, {}) is not finite; leave it out", i,
                                                   points[i][0], points[i][1], points[i][2]));
}

// A corner as an index. Throws where there is no such point.
std::uint32_t cornerOf(std::int64_t corner, std::size_t points, std::size_t face, const std::string& name) {
    if (corner >= 0 && corner < static_cast<std::int64_t>(points)) return static_cast<std::uint32_t>(corner);
    throw InputError(name, fmt::format("face {} has the corner {}; there are {} points, counted from 0", face,
                                       corner, points));
}

}  // namespace

std::vector<Point> pointsOf(const PointArray& array) {
    std::vector<Point> points(static_cast<std::size_t>(array.shape(0)));
    if (!points.empty()) std::memcpy(points.data(), array.data(), points.size() * sizeof(Point));
    return points;
}

py::array_t<double> arrayOf(const std::vector<Vec3>& points) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t(3)});
    if (!points.empty()) std::memcpy(array.mutable_data(), points.data(), points.size() * sizeof(Vec3));
    return array;
}

TriangleMesh meshOf(const PointArray& points, const IndexArray& triangles, const std::string& name) {
    TriangleMesh mesh;
    mesh.points = pointsOf(points);
    requireFinite(mesh.points, name);
    const auto count = static_cast<std::size_t>(triangles.shape(0));
    if (count == 0) throw InputError(name, "has no triangles");
    mesh.triangles.resize(count);
    for (std::size_t f = 0; f < count; ++f)
        for (std::size_t c = 0; c < 3; ++c)
            mesh.triangles[f][c] = cornerOf(triangles.data()[3 * f + c], mesh.points.size(), f, name);
    return mesh;
}

subdivision::PolygonMesh polygonsOf(const PointArray& points, const IndexArray& corners,
                                    const IndexArray& sizes) {
    subdivision::PolygonMesh mesh;
    const std::vector<Point> all = pointsOf(points);
    requireFinite(all, "mesh");
    for (const Point& p : all) mesh.points.push_back({p[0], p[1], p[2]});
    std::size_t at = 0;
    for (py::ssize_t f = 0; f < sizes.shape(0); ++f) {
        for (std::int64_t c = 0; c < sizes.data()[f]; ++c)
            mesh.corners.push_back(
                cornerOf(corners.data()[at++], all.size(), static_cast<std::size_t>(f), "mesh"));
        mesh.faceBegin.push_back(static_cast<subdivision::Index>(mesh.corners.size()));
    }
    return mesh;
}

py::tuple tupleOf(const subdivision::PolygonMesh& mesh) {
    py::array_t<std::int32_t> corners(static_cast<py::ssize_t>(mesh.corners.size()));
    py::array_t<std::int32_t> sizes(static_cast<py::ssize_t>(mesh.faceCount()));
    for (std::size_t i = 0; i < mesh.corners.size(); ++i)
        corners.mutable_data()[i] = static_cast<std::int32_t>(mesh.corners[i]);
    for (std::size_t f = 0; f < mesh.faceCount(); ++f)
        sizes.mutable_data()[f] = static_cast<std::int32_t>(mesh.faceSize(f));
    return py::make_tuple(arrayOf(mesh.points), corners, sizes);
}

}  // namespace isowave::python
