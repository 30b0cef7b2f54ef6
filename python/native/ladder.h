// Ladders of meshes.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindLadder(py::module_& module);

}  // namespace isowave::python
