// Solids: voxels in arrays, meshes in arrays, files.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindSolid(py::module_& module);

}  // namespace isowave::python
