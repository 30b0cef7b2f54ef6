// The library's exceptions as those of isowave/errors.py.
#pragma once

#include "python/native/pybind.h"

namespace isowave::python {

// InputError, UsageError and OperationError keep their names and their one line; Cancelled is KeyboardInterrupt, std::bad_alloc
// MemoryError.
void bindErrors(py::module_& module);

}  // namespace isowave::python
