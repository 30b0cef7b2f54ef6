#include "python/native/measure.h"

#include <cmath>
#include <limits>

#include "isowave/error.h"
#include "isowave/measure.h"
#include "python/native/arrays.h"
#include "python/native/watch.h"
#include "tools/report/mesh_report.h"

namespace isowave::python {
namespace {

// A mesh to be measured: of a file or of arrays, in LPS.
struct Measured {
    TriangleMesh mesh;
    std::string name, format;
};
using MeasuredPointer = std::shared_ptr<Measured>;

// What says RAS is turned half round about z: orientation stays.
void turnToLps(TriangleMesh& mesh) {
    for (Point& p : mesh.points) p[0] = -p[0], p[1] = -p[1];
}

MeasuredPointer read(const std::filesystem::path& path, const py::object& watch) {
    return watched(watch, [&](const Progress& progress) {
        auto measured = std::make_shared<Measured>();
        MeshFileInfo info;
        measured->mesh = readMesh(path, &info, progress);
        if (info.space == "RAS") turnToLps(measured->mesh);
        measured->name = path.string();
        measured->format = info.format;
        return measured;
    });
}

MeasuredPointer taken(const PointArray& points, const IndexArray& triangles, const std::string& name) {
    return std::make_shared<Measured>(Measured{meshOf(points, triangles, name), name, "triangles in memory"});
}

double diagonalOf(const TriangleMesh& mesh) {
    Point low, high;
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
    for (const Point& p : mesh.points)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    return std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
}

// sampling: world units; nothing: as `isowave compare` takes it, 1/500 of A's diagonal.
std::string compare(const Measured& a, const Measured& b, std::optional<double> sampling,
                    const py::object& watch) {
    constexpr double kSamplesPerDiagonal = 500;
    if (sampling && !(*sampling > 0 && std::isfinite(*sampling)))
        throw UsageError("--sampling: '" + std::to_string(*sampling) + "' is not above 0");
    tools::CompareReport report{
        a.name, b.name, sampling.value_or(diagonalOf(a.mesh) / kSamplesPerDiagonal), {}};
    report.comparison = watched(watch, [&](const Progress& progress) {
        return compareMeshes(a.mesh, b.mesh, report.sampling, progress);
    });
    return tools::jsonOf(report);
}

std::string check(const Measured& measured, bool selfIntersections, const py::object& watch) {
    return tools::jsonOf(watched(watch, [&](const Progress& progress) {
        const TriangleMesh mesh = mergeEqualPoints(measured.mesh);
        tools::CheckReport report{measured.name, measured.format, topologyOf(mesh), {}};
        if (selfIntersections) report.selfIntersections = countSelfIntersections(mesh, progress);
        return report;
    }));
}

}  // namespace

void bindMeasure(py::module_& module) {
    py::class_<Measured, MeasuredPointer>(module, "Measured");
    module.def("read_mesh", read);
    module.def("take_mesh", taken);
    module.def("compare", compare);
    module.def("check", check);
    module.def("can_measure_distances", canMeasureDistances);
}

}  // namespace isowave::python
