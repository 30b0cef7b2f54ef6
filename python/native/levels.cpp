#include "python/native/levels.h"

#include <algorithm>
#include <fstream>
#include <memory>

#include "isowave/error.h"
#include "isowave/subdivision.h"
#include "python/native/arrays.h"
#include "python/native/watch.h"
#include "subdivision/curves/curve_details.h"
#include "subdivision/curves/curve_files.h"
#include "subdivision/lattice/grid_files.h"
#include "tools/output.h"
#include "tools/report/curve_levels.h"
#include "tools/report/hierarchy.h"
#include "tools/report/relief.h"

namespace isowave::python {
namespace {

using namespace subdivision;
namespace fs = std::filesystem;

// A file of details as bytes, beside what is read of it.
void saveBytes(const std::string& bytes, const fs::path& path) {
    const py::gil_scoped_release release;
    tools::ResultFile file(path);
    file.write(bytes);
    file.commit();
}

// What the library complains of is the fault of `name`.
template <class Work>
auto of(const std::string& name, const Work& work) -> decltype(work()) {
    try {
        return work();
    } catch (const InputError& error) {
        throw InputError(name, error.what());
    }
}

// ---- curves

// points (N, 2) or (N, 3), and whether the curve is closed.
using CurveParts = std::pair<PointArray, bool>;

Polyline polylineOf(const CurveParts& parts) {
    const auto& [points, closed] = parts;
    Polyline curve;
    curve.dimension = static_cast<int>(points.shape(1));
    curve.closed = closed;
    curve.coordinates.assign(points.data(), points.data() + points.size());
    return curve;
}

std::vector<Polyline> polylinesOf(const std::vector<CurveParts>& parts) {
    std::vector<Polyline> curves;
    for (const CurveParts& part : parts) curves.push_back(polylineOf(part));
    return curves;
}

py::list listOf(const std::vector<Polyline>& curves) {
    py::list list;
    for (const Polyline& curve : curves) {
        py::array_t<double> points({static_cast<py::ssize_t>(curve.size()), py::ssize_t{curve.dimension}});
        std::copy(curve.coordinates.begin(), curve.coordinates.end(), points.mutable_data());
        list.append(py::make_tuple(points, curve.closed));
    }
    return list;
}

struct MadeCurves {
    CurveSet set;
    std::string report;  // JSON; empty for those that were read
    std::vector<std::string> remarks;
};
using CurvesPointer = std::shared_ptr<MadeCurves>;

CurvesPointer takenApart(std::vector<Polyline> curves, const std::string& name,
                         const CurveReportOptions& options) {
    return of(name, [&] {
        const CurveReport report = reportCurves(std::move(curves), options);
        return std::make_shared<MadeCurves>(MadeCurves{readCurveDetails(report.details, name),
                                                       tools::jsonOf(report), tools::remarks(report)});
    });
}

CurvesPointer curveLevels(const std::vector<CurveParts>& parts, const std::optional<fs::path>& path,
                          const std::string& scheme, const std::string& mask, int width, int depth,
                          std::optional<std::size_t> resample, std::optional<double> threshold,
                          std::optional<std::size_t> keep, const py::object& watch) {
    const CurveReportOptions options{.scheme = scheme,
                                     .mask = mask,
                                     .width = width,
                                     .levels = depth,
                                     .resample = resample,
                                     .threshold = threshold,
                                     .keep = keep,
                                     .details = true};
    std::vector<Polyline> given = polylinesOf(parts);
    return watched(watch, [&](const Progress&) {
        if (path) return takenApart(CurveFile::read(*path).curves(), path->string(), options);
        return takenApart(std::move(given), "curves", options);
    });
}

CurvesPointer loadCurves(const fs::path& path, const py::object& watch) {
    return watched(watch, [&](const Progress&) {
        return std::make_shared<MadeCurves>(MadeCurves{loadCurveDetails(path), {}, {}});
    });
}

std::vector<Polyline> coarseOf(const CurveSet& set) {
    std::vector<Polyline> coarse;
    for (const CurveLevels& curve : set.curves) coarse.push_back(curve.coarse);
    return coarse;
}

Frames framesOf(const std::string& name) {
    if (name == "global") return Frames::global;
    if (name == "local") return Frames::local;
    throw UsageError("--frames: '" + name + "' is not one of global, local");
}

// The curves, and the report as JSON.
py::tuple rebuiltCurves(const MadeCurves& made, int depth,
                        const std::optional<std::vector<CurveParts>>& moved, const std::string& frames,
                        std::optional<double> threshold, std::optional<std::size_t> keep, bool limit,
                        const py::object& watch) {
    CurveRebuildOptions options{.frames = framesOf(frames),
                                .depth = depth,
                                .threshold = threshold,
                                .keep = keep,
                                .positions = limit ? Positions::limit : Positions::control};
    if (moved) options.moved = polylinesOf(*moved);
    const RebuiltCurves result = watched(
        watch, [&](const Progress&) { return of("curves", [&] { return rebuild(made.set, options); }); });
    return py::make_tuple(listOf(result.curves), tools::jsonOf(result.report));
}

// ---- heights

struct MadeRelief {
    ReliefDetails details;
    std::string bytes;   // of the file
    std::string report;  // JSON; empty for one that was read
};
using ReliefPointer = std::shared_ptr<MadeRelief>;

// (rows, columns), or (rows, columns, channels).
Grid gridOf(const PointArray& heights) {
    Grid grid;
    grid.rows = static_cast<std::size_t>(heights.shape(0));
    grid.columns = static_cast<std::size_t>(heights.shape(1));
    grid.channels = heights.ndim() == 3 ? static_cast<std::size_t>(heights.shape(2)) : 1;
    grid.values.assign(heights.data(), heights.data() + heights.size());
    return grid;
}

py::array_t<double> arrayOfGrid(const Grid& grid) {
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(grid.rows),
                                   static_cast<py::ssize_t>(grid.columns)};
    if (grid.channels > 1) shape.push_back(static_cast<py::ssize_t>(grid.channels));
    py::array_t<double> heights(shape);
    std::copy(grid.values.begin(), grid.values.end(), heights.mutable_data());
    return heights;
}

ReliefPointer relief(const std::optional<PointArray>& heights, const std::optional<fs::path>& path,
                     const std::string& scheme, int depth, const py::object& watch) {
    Grid given;
    if (heights) given = gridOf(*heights);
    return watched(watch, [&](const Progress&) {
        const Grid grid = path ? readGrid(*path) : std::move(given);
        const std::string name = path ? path->string() : "heights";
        return of(name, [&] {
            ReliefReport report = reportRelief(grid, {.scheme = scheme, .levels = depth, .details = true});
            return std::make_shared<MadeRelief>(
                MadeRelief{ReliefDetails::read(report.details, name), report.details, tools::jsonOf(report)});
        });
    });
}

ReliefPointer loadRelief(const fs::path& path, const py::object& watch) {
    return watched(watch, [&](const Progress&) {
        ReliefDetails details = ReliefDetails::load(path);
        std::ifstream file(path, std::ios::binary);
        std::string bytes{std::istreambuf_iterator<char>(file), {}};
        return std::make_shared<MadeRelief>(MadeRelief{std::move(details), std::move(bytes), {}});
    });
}

py::tuple rebuiltRelief(const MadeRelief& made, int depth, const std::optional<PointArray>& edited,
                        std::optional<double> threshold, std::optional<std::size_t> keep, bool limit,
                        const py::object& watch) {
    ReliefRebuildOptions options{.depth = depth,
                                 .threshold = threshold,
                                 .keep = keep,
                                 .positions = limit ? Positions::limit : Positions::control};
    if (edited) options.edited = gridOf(*edited);
    const RebuiltRelief result = watched(
        watch, [&](const Progress&) { return of("heights", [&] { return made.details.rebuild(options); }); });
    return py::make_tuple(arrayOfGrid(result.heights), tools::jsonOf(result.report));
}

}  // namespace

void bindLevels(py::module_& module) {
    py::class_<MadeCurves, CurvesPointer>(module, "CurveDetails")
        .def_property_readonly(
            "scheme",
            [](const MadeCurves& made) { return made.set.scheme.empty() ? made.set.mask : made.set.scheme; })
        .def_property_readonly("levels", [](const MadeCurves& made) { return made.set.levels; })
        .def_property_readonly("report", [](const MadeCurves& made) { return made.report; })
        .def_property_readonly("remarks", [](const MadeCurves& made) { return made.remarks; })
        .def("coarse", [](const MadeCurves& made) { return listOf(coarseOf(made.set)); })
        .def("rebuild", rebuiltCurves)
        .def("save", [](const MadeCurves& made, const fs::path& path) {
            saveBytes(curveDetailsBytes(made.set), path);
        });
    module.def("curve_levels", curveLevels);
    module.def("load_curve_details", loadCurves);
    py::class_<MadeRelief, ReliefPointer>(module, "ReliefDetails")
        .def_property_readonly("scheme", [](const MadeRelief& made) { return made.details.scheme(); })
        .def_property_readonly("levels", [](const MadeRelief& made) { return made.details.levels(); })
        .def_property_readonly("report", [](const MadeRelief& made) { return made.report; })
        .def("coarse", [](const MadeRelief& made) { return arrayOfGrid(made.details.coarseHeights()); })
        .def("rebuild", rebuiltRelief)
        .def("save", [](const MadeRelief& made, const fs::path& path) { saveBytes(made.bytes, path); });
    module.def("relief", relief);
    module.def("load_relief_details", loadRelief);
}

}  // namespace isowave::python
