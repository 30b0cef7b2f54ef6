// pybind11 as all sources of the module include it, and what they share.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace isowave::python {
namespace py = pybind11;
}  // namespace isowave::python
