#include "python/native/solid.h"

#include <fmt/format.h>

#include "isowave/error.h"
#include "isowave/pyramid.h"
#include "isowave/solid.h"
#include "python/native/arrays.h"
#include "python/native/options.h"
#include "python/native/watch.h"

namespace isowave::python {
namespace {

// NumPy's names are the library's, but for bool, whose bytes are 0 and 1.
std::string typeOf(const py::array& array) {
    const auto name = array.dtype().attr("name").cast<std::string>();
    return name == "bool" ? "uint8" : name;
}

// axes: the last three columns of an affine matrix 3 x 4, then its first: origin, x, y, z.
AffineTransform transformOf(const std::vector<double>& axes) {
    AffineTransform transform;
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t a = 0; a < 3; ++a) transform.axis[a][row] = axes[4 * row + a];
        transform.origin[row] = axes[4 * row + 3];
    }
    return transform;
}

// array: index 0 along x, 1 along y, 2 along z. affine: 3 x 4, row by row, voxels to LPS.
VoxelView viewOf(const py::array& array, bool bigEndian, const std::vector<double>& affine) {
    VoxelView view;
    view.data = array.data();
    view.type = typeOf(array);
    view.bigEndian = bigEndian;
    for (std::size_t a = 0; a < 3; ++a) {
        view.size[a] = array.shape(static_cast<py::ssize_t>(a));
        view.stride[a] = array.strides(static_cast<py::ssize_t>(a));
    }
    view.indexToWorld = transformOf(affine);
    return view;
}

Solid openFile(const std::filesystem::path& path, const GivenOptions& given, int finestStep,
               const py::object& watch) {
    SolidChoices choices(given);
    choices.solid.finestStep = finestStep;
    return watched(watch, [&](const Progress& progress) { return open(path, choices.solid, progress); });
}

// A Python object that may go on a thread without the GIL.
std::shared_ptr<py::object> held(py::object object) {
    return {new py::object(std::move(object)), [](py::object* o) {
                const py::gil_scoped_acquire acquire;
                delete o;
            }};
}

// memory: bytes a slab, 130 MB of them for the process. run(tasks, report): what the tasks tell, in order; None where report(share)
// said False, which asks to stop.
Solid openInSlabs(const std::filesystem::path& path, const GivenOptions& given, int slabs,
                  const std::optional<double>& memory, const std::filesystem::path& folder, py::object run,
                  const py::object& watch) {
    SolidChoices choices(given);
    choices.solid.slabs = slabs;
    choices.solid.slabMemory = memory;
    choices.solid.slabFolder = folder;
    choices.solid.slabMap = [run = held(std::move(run))](const std::vector<std::string>& tasks,
                                                         const Progress& progress) {
        const py::gil_scoped_acquire acquire;
        const py::cpp_function report([&progress](double share) {
            if (progress.report) progress.report("slabs", share);
            return !(progress.stopRequested && progress.stopRequested());
        });
        const py::object told = (*run)(tasks, report);
        if (told.is_none()) throw Cancelled();
        return told.cast<std::vector<std::string>>();
    };
    return watched(watch, [&](const Progress& progress) { return open(path, choices.solid, progress); });
}

std::string slabTask(const std::filesystem::path& path, const GivenOptions& given, const std::string& task,
                     const py::object& watch) {
    const SolidChoices choices(given);
    return watched(
        watch, [&](const Progress& progress) { return runSlabTask(path, choices.solid, task, progress); });
}

Solid openVoxels(const py::array& array, bool bigEndian, const std::vector<double>& affine,
                 const GivenOptions& given, const py::object& watch) {
    const SolidChoices choices(given);
    const VoxelView view = viewOf(array, bigEndian, affine);
    return watched(watch, [&](const Progress& progress) { return open(view, choices.solid, progress); });
}

Solid openTriangles(const PointArray& points, const IndexArray& triangles, const GivenOptions& given,
                    const py::object& watch) {
    const SolidChoices choices(given);
    const TriangleMesh mesh = meshOf(points, triangles, "mesh");
    return watched(watch, [&](const Progress& progress) { return open(mesh, choices.solid, progress); });
}

const char* nameOf(Space space) {
    return space == Space::unspecified ? "" : space == Space::lps ? "LPS" : "RAS";
}

}  // namespace

void bindSolid(py::module_& module) {
    py::class_<Solid>(module, "Solid")
        .def_property_readonly("space", [](const Solid& solid) { return nameOf(solid.space()); })
        .def_property_readonly("is_pyramid", &Solid::isPyramid);
    module.def("open_file", openFile);
    module.def("open_voxels", openVoxels);
    module.def("open_in_slabs", openInSlabs);
    module.def("run_slab_task", slabTask);
    module.def("open_triangles", openTriangles);
    module.def("solid_of", solidOf);
    module.def("solid_option_names", solidOptionNames);
}

}  // namespace isowave::python
