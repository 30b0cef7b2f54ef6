#include "python/native/filters.h"

#include "isowave/error.h"
#include "isowave/filters.h"

namespace isowave::python {
namespace {

using namespace subdivision;

Lattice latticeOf(const std::string& name) {
    if (name == "line") return Lattice::Line;
    if (name == "triangular") return Lattice::Triangular;
    if (name == "quad") return Lattice::Quad;
    throw UsageError("--lattice: '" + name + "' is not one of line, triangular, quad");
}

const char* nameOf(Lattice lattice) {
    return lattice == Lattice::Line ? "line" : lattice == Lattice::Triangular ? "triangular" : "quad";
}

// ((x, y), [(x, y, "23/196"), ...])
py::tuple tupleOf(const Filter& filter) {
    py::list taps;
    for (const FilterTap& tap : filter.taps) taps.append(py::make_tuple(tap.x, tap.y, tap.value));
    return py::make_tuple(py::make_tuple(filter.x, filter.y), taps);
}

py::list listOf(const std::vector<Filter>& filters) {
    py::list list;
    for (const Filter& filter : filters) list.append(tupleOf(filter));
    return list;
}

py::dict dictOf(const FilterSet& set) {
    py::dict dict;
    dict["subdivision"] = set.subdivision;
    dict["lattice"] = nameOf(set.lattice);
    dict["width"] = set.width;
    dict["P"] = tupleOf(set.p);
    dict["A"] = tupleOf(set.a);
    dict["B"] = listOf(set.b);
    dict["Q"] = listOf(set.q);
    dict["products"] = set.products;
    dict["failure"] = set.failure;
    return dict;
}

template <class Make>
py::dict made(const Make& make) {
    const FilterSet set = [&] {
        const py::gil_scoped_release release;
        return make();
    }();
    return dictOf(set);
}

}  // namespace

void bindFilters(py::module_& module) {
    module.def("named_filters", [](const std::string& name, std::optional<int> width) {
        return made([&] { return filterSet(name, width); });
    });
    module.def("mask_filters",
               [](const std::string& mask, const std::string& lattice, std::optional<int> width) {
                   const Lattice where = latticeOf(lattice);
                   return made([&] { return maskFilterSet(mask, where, width); });
               });
}

}  // namespace isowave::python
