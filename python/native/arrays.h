// NumPy's arrays and the library's vectors.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/subdivision.h"
#include "python/native/pybind.h"

namespace isowave::python {

// A read-only array of shape (rows, Columns) over memory that lives as long as `owner`.
template <class Shown, std::size_t Columns, class Stored>
py::array rowsOf(const std::vector<std::array<Stored, Columns>>& rows, const py::object& owner) {
    static_assert(sizeof(Stored) == sizeof(Shown));
    py::array_t<Shown> view({static_cast<py::ssize_t>(rows.size()), static_cast<py::ssize_t>(Columns)},
                            reinterpret_cast<const Shown*>(rows.data()), owner);
    view.attr("setflags")(py::arg("write") = false);
    return view;
}

using PointArray = py::array_t<double, py::array::c_style | py::array::forcecast>;
using IndexArray = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

std::vector<Point> pointsOf(const PointArray& array);
py::array_t<double> arrayOf(const std::vector<Vec3>& points);

// points (V, 3), triangles (F, 3). Throws InputError, after `name`: a corner that is no point (which triangle), a coordinate that
// is not finite (which point), no triangles.
TriangleMesh meshOf(const PointArray& points, const IndexArray& triangles, const std::string& name);

// corners: the points of each face, face after face; sizes: how many a face has. Throws InputError as meshOf() does.
subdivision::PolygonMesh polygonsOf(const PointArray& points, const IndexArray& corners,
                                    const IndexArray& sizes);
// points (V, 3), corners, sizes.
py::tuple tupleOf(const subdivision::PolygonMesh& mesh);

}  // namespace isowave::python
