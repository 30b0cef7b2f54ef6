// Curves and heights by reversing subdivision, and their files of details.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindLevels(py::module_& module);

}  // namespace isowave::python
