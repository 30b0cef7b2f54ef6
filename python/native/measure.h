// What meshes are, and how far they are apart.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindMeasure(py::module_& module);

}  // namespace isowave::python
