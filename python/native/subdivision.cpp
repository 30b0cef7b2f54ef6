#include "python/native/subdivision.h"

#include <memory>

#include "isowave/error.h"
#include "isowave/subdivision.h"
#include "python/native/arrays.h"
#include "python/native/watch.h"
#include "subdivision/meshes/mesh_files.h"
#include "tools/output.h"
#include "tools/report/hierarchy.h"

namespace isowave::python {
namespace {

using namespace subdivision;

// A polygon mesh with its name, for messages.
struct Polygons {
    PolygonMesh mesh;
    std::string name;
};
using PolygonsPointer = std::shared_ptr<Polygons>;

struct MadeHierarchy {
    Hierarchy hierarchy;
    std::string report;  // JSON; empty for one that was read
};
using HierarchyPointer = std::shared_ptr<MadeHierarchy>;

using Creases = std::vector<std::tuple<std::int64_t, std::int64_t, double>>;

PolygonsPointer taken(const PointArray& points, const IndexArray& corners, const IndexArray& sizes,
                      const Creases& creases) {
    auto polygons = std::make_shared<Polygons>(Polygons{polygonsOf(points, corners, sizes), "mesh"});
    for (const auto& [a, b, sharpness] : creases) {
        if (a < 0 || b < 0) throw InputError("mesh", "a crease has a vertex below 0");
        polygons->mesh.creases.push_back({static_cast<Index>(a), static_cast<Index>(b), sharpness});
    }
    return polygons;
}

PolygonsPointer read(const std::filesystem::path& path, const py::object& watch) {
    return watched(watch, [&](const Progress& progress) {
        std::vector<std::string> remarks;
        auto polygons = std::make_shared<Polygons>(Polygons{readPolygonMesh(path, &remarks), path.string()});
        for (const std::string& remark : remarks) progress.say(remark);
        return polygons;
    });
}

// Messages of the library do not know what a mesh is called.
template <class Work>
auto named(const Polygons& polygons, const py::object& watch, const Work& work) {
    return watched(watch, [&](const Progress& progress) {
        try {
            return work(progress);
        } catch (const InputError& error) {
            throw InputError(polygons.name, error.what());
        }
    });
}

py::tuple subdivide(const Polygons& polygons, const std::string& scheme, int depth, bool limit,
                    const py::object& watch) {
    requireManifold(polygons.mesh, polygons.name);
    return tupleOf(named(polygons, watch, [&](const Progress& progress) {
        PolygonMesh fine = subdivided(polygons.mesh, scheme, depth, progress);
        if (limit) fine.points = limitPoints(fine, scheme);
        return fine;
    }));
}

HierarchyPointer reverse(const Polygons& polygons, const std::string& scheme, const std::string& variant,
                         int depth, std::optional<double> crease, const py::object& watch) {
    return named(polygons, watch, [&](const Progress& progress) {
        const DecomposeOptions options{.variant = variant, .levels = depth, .creaseAngle = crease};
        auto made = std::make_shared<MadeHierarchy>();
        made->hierarchy = decompose(polygons.mesh, scheme, options, progress);
        made->report = tools::jsonOf(reportDecomposition(made->hierarchy, polygons.mesh, progress));
        return made;
    });
}

HierarchyPointer load(const std::filesystem::path& path, const py::object& watch) {
    return watched(watch, [&](const Progress&) {
        return std::make_shared<MadeHierarchy>(MadeHierarchy{loadHierarchy(path), {}});
    });
}

void save(const MadeHierarchy& made, const std::filesystem::path& path, std::optional<double> shortest,
          std::optional<std::size_t> count) {
    const py::gil_scoped_release release;
    Hierarchy hierarchy = made.hierarchy;
    if (shortest) threshold(hierarchy, *shortest);
    if (count) keepLongest(hierarchy, *count);
    tools::OutputFile out(path);
    saveHierarchy(path, hierarchy);
    out.commit();
}

std::vector<Vec3> vectorsOf(const PointArray& array) {
    std::vector<Vec3> vectors;
    for (const Point& p : pointsOf(array)) vectors.push_back({p[0], p[1], p[2]});
    return vectors;
}

Frames framesOf(const std::string& name) {
    if (name == "global") return Frames::global;
    if (name == "local") return Frames::local;
    throw UsageError("--frames: '" + name + "' is not one of global, local");
}

// The mesh after `steps` steps (-1: all) of the simplified and edited hierarchy, and the report as JSON.
py::tuple rebuilt(const MadeHierarchy& made, int steps, const std::optional<PointArray>& moved,
                  const std::string& frames, std::optional<double> threshold, std::optional<std::size_t> keep,
                  bool limit, const py::object& watch) {
    RebuildOptions options{.frames = framesOf(frames),
                           .threshold = threshold,
                           .keep = keep,
                           .positions = limit ? Positions::limit : Positions::control};
    if (moved) options.moved = vectorsOf(*moved);
    if (steps > made.hierarchy.steps())
        throw UsageError("--depth: there are " + std::to_string(made.hierarchy.steps()) + " levels");
    const Rebuilt result = watched(watch, [&](const Progress& progress) {
        Hierarchy hierarchy = made.hierarchy;
        if (steps >= 0 && steps < hierarchy.steps()) {
            hierarchy.details.resize(static_cast<std::size_t>(steps));
            hierarchy.truncated = true;
            hierarchy.order = {};
        }
        return rebuild(std::move(hierarchy), options, progress);
    });
    return py::make_tuple(tupleOf(result.mesh), tools::jsonOf(result.report));
}

py::list detailsOf(const MadeHierarchy& made) {
    py::list list;
    for (const auto& details : made.hierarchy.details) list.append(arrayOf(details));
    return list;
}

}  // namespace

void bindSubdivision(py::module_& module) {
    py::class_<Polygons, PolygonsPointer>(module, "Polygons");
    py::class_<MadeHierarchy, HierarchyPointer>(module, "Hierarchy")
        .def_property_readonly("scheme", [](const MadeHierarchy& made) { return made.hierarchy.scheme; })
        .def_property_readonly("variant", [](const MadeHierarchy& made) { return made.hierarchy.variant; })
        .def_property_readonly("steps", [](const MadeHierarchy& made) { return made.hierarchy.steps(); })
        .def_property_readonly("report", [](const MadeHierarchy& made) { return made.report; })
        .def("base", [](const MadeHierarchy& made) { return tupleOf(made.hierarchy.base); })
        .def("details", detailsOf)
        .def("rebuild", rebuilt)
        .def("save", save);
    module.def("take_polygons", taken);
    module.def("read_polygons", read);
    module.def("subdivide", subdivide);
    module.def("reverse", reverse);
    module.def("load_hierarchy", load);
}

}  // namespace isowave::python
