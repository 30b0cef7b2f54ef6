// Ladders of plane curves.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindCurves(py::module_& module);

}  // namespace isowave::python
