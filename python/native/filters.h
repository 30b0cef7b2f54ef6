// Filters of subdivisions.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindFilters(py::module_& module);

}  // namespace isowave::python
