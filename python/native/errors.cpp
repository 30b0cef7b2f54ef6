#include "python/native/errors.h"

#include "isowave/error.h"
#include "isowave/progress.h"

namespace isowave::python {
namespace {

void raise(const char* name, const std::exception& error) {
    const py::object type = py::module_::import("isowave.errors").attr(name);
    PyErr_SetString(type.ptr(), error.what());
}

void translate(std::exception_ptr pointer) {
    try {
        if (pointer) std::rethrow_exception(pointer);
    } catch (const UsageError& error) {
        raise("UsageError", error);
    } catch (const InputError& error) {
        raise("InputError", error);
    } catch (const OperationError& error) {
        raise("OperationError", error);
    } catch (const Cancelled&) {
        PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
}

}  // namespace

void bindErrors(py::module_&) { py::register_exception_translator(translate); }

}  // namespace isowave::python
