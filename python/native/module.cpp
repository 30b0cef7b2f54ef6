// isowave._native: the public library, bound thinly; python/isowave makes it pleasant.
#include "isowave/version.h"
#include "python/native/curves.h"
#include "python/native/edits.h"
#include "python/native/errors.h"
#include "python/native/filters.h"
#include "python/native/ladder.h"
#include "python/native/levels.h"
#include "python/native/measure.h"
#include "python/native/pyramid.h"
#include "python/native/solid.h"
#include "python/native/subdivision.h"

PYBIND11_MODULE(_native, module) {
    module.doc() = "The library behind isowave; not an interface.";
    module.attr("version") = ISOWAVE_VERSION;
    isowave::python::bindErrors(module);
    isowave::python::bindSolid(module);
    isowave::python::bindLadder(module);
    isowave::python::bindPyramid(module);
    isowave::python::bindEdits(module);
    isowave::python::bindMeasure(module);
    isowave::python::bindCurves(module);
    isowave::python::bindFilters(module);
    isowave::python::bindSubdivision(module);
    isowave::python::bindLevels(module);
}
