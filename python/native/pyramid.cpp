#include "python/native/pyramid.h"

#include "isowave/error.h"
#include "isowave/field.h"
#include "isowave/ladder.h"
#include "isowave/pyramid.h"
#include "python/native/arrays.h"
#include "python/native/options.h"
#include "python/native/watch.h"
#include "tools/output.h"
#include "tools/report/info_report.h"

namespace isowave::python {
namespace {

// f at each point, without the GIL. Result: a double, or three, a point.
template <std::size_t Columns, class F>
py::array_t<double> atEach(const PointArray& array, const F& f) {
    const std::vector<Point> points = pointsOf(array);
    py::array_t<double> values({static_cast<py::ssize_t>(points.size()), static_cast<py::ssize_t>(Columns)});
    double* out = values.mutable_data();
    const py::gil_scoped_release release;
    for (const Point& p : points) out = f(p, out);
    return values;
}

py::array_t<double> valuesOf(const Field& field, const PointArray& points) {
    return atEach<1>(points, [&](const Point& p, double* out) {
        *out = field.value(p);
        return out + 1;
    });
}

py::array_t<double> gradientsOf(const Field& field, const PointArray& points) {
    return atEach<3>(points, [&](const Point& p, double* out) {
        const Point gradient = field.gradient(p);
        return std::copy(gradient.begin(), gradient.end(), out);
    });
}

// A mesh whose arrays are views of it.
py::tuple arraysOf(TriangleMesh mesh) {
    const py::object owner = py::cast(std::make_shared<TriangleMesh>(std::move(mesh)));
    const auto& held = *owner.cast<std::shared_ptr<TriangleMesh>>();
    return py::make_tuple(rowsOf<double>(held.points, owner), rowsOf<std::int32_t>(held.triangles, owner),
                          rowsOf<float>(held.normals, owner));
}

py::tuple polygonized(const Field& field, int refine, double iso, const py::object& watch) {
    return arraysOf(watched(watch, [&](const Progress& progress) {
        return field.polygonize({.refine = refine, .iso = iso}, progress);
    }));
}

void requireName(const Field&, const std::filesystem::path& path) {
    if (path.extension() != ".vdb") throw UsageError(path.string() + ": fields are .vdb files; name it so");
}
void requireName(const Pyramid&, const std::filesystem::path& path) {
    if (path.extension() != ".vdb" && path.extension() != ".iwz")
        throw UsageError(path.string() + ": pyramids are .vdb files, packed ones .iwz; name it so");
}

template <class Saved>
void save(const Saved& saved, const std::filesystem::path& path) {
    requireName(saved, path);
    const py::gil_scoped_release release;
    tools::OutputFile out(path);
    saved.save(path);
    out.commit();
}

Pyramid load(const std::filesystem::path& path, const py::object& watch) {
    return watched(watch, [&](const Progress& progress) { return Pyramid::open(path, 0, progress); });
}

Pyramid taken(const Solid& solid, const py::object& watch) {
    return watched(watch, [&](const Progress& progress) { return analyse(solid, progress); });
}

Field fieldAt(const Pyramid& pyramid, int step, const py::object& watch) {
    return watched(watch, [&](const Progress& progress) { return pyramid.field(step, progress); });
}

Field fieldOfSolid(const Solid& solid, int step, const py::object& watch) {
    return watched(watch, [&](const Progress& progress) { return fieldOf(solid, step, progress); });
}

std::string stepsOf(const Pyramid& pyramid) { return tools::dumped(tools::stepsJson(pyramid.steps())); }

}  // namespace

void bindPyramid(py::module_& module) {
    py::class_<TriangleMesh, std::shared_ptr<TriangleMesh>>(module, "TriangleMesh");
    py::class_<Field>(module, "Field")
        .def_property_readonly("K", &Field::K)
        .def_property_readonly("control_point_count", &Field::controlPointCount)
        .def_property_readonly("spacing", &Field::spacing)
        .def("values", valuesOf)
        .def("gradients", gradientsOf)
        .def("polygonize", polygonized)
        .def("save", save<Field>);
    py::class_<Pyramid>(module, "Pyramid")
        .def_property_readonly("K", &Pyramid::K)
        .def_property_readonly("step_count", &Pyramid::stepCount)
        .def_property_readonly("coefficients_stored", &Pyramid::coefficientsStored)
        .def_property_readonly("control_points", &Pyramid::controlPoints)
        .def_property_readonly("memory_bytes", &Pyramid::memoryBytes)
        .def_property_readonly("source", [](const Pyramid& pyramid) { return pyramid.source(); })
        .def("steps", stepsOf)
        .def("field", fieldAt)
        .def("save", save<Pyramid>);
    module.def("load_pyramid", load);
    module.def("analyse", taken);
    module.def("field_of", fieldOfSolid);
}

}  // namespace isowave::python
