// Meshes by reversing subdivision.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindSubdivision(py::module_& module);

}  // namespace isowave::python
