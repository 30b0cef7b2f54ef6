// Pyramids, and the fields of their steps.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindPyramid(py::module_& module);

}  // namespace isowave::python
