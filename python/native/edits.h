// Edits of a pyramid.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

void bindEdits(py::module_& module);

}  // namespace isowave::python
