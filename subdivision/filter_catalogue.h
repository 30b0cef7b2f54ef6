// The filters of all schemes, by one name: a catalogue above the four folders.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subdivision/filters/construct.h"

namespace isowave::subdivision {

// filterSet() and maskFilterSet() of isowave/filters.h, before the numbers become text.
Filters namedFilters(std::string_view name, std::optional<int> width);
// This width, or the smallest there is.
Filters maskFilters(const Mask& mask, std::optional<int> width);

// A row of A or B, or a column of P or Q, that differs from the interior's.
struct BoundaryDiagram {
    char filter;         // 'A', 'B', 'P', 'Q'
    std::string place;   // of surfaces: "on the side", "one level in", ..
    std::size_t number;  // of curves: counted from the end
    bool asInside;       // of curves: the first that only moves on from here
    Diagram diagram;
    Node centre;
};

struct BoundaryFilters {
    std::string scheme;
    Lattice lattice = Lattice::Line;
    std::size_t coarsePoints = 0, finePoints = 0, products = 0;  // of curves: what was proved
    std::vector<BoundaryDiagram> diagrams;
};

// Of a curve scheme the columns of P, the rows of A and B, and the columns of Q beside an end, up to the first that
// repeats; of Butterfly or Loop the rows of P across and beside a side, and those of A on it and one, two .. levels in.
// Throws InputError for a name that has no boundary rules.
BoundaryFilters boundaryFilters(std::string_view name);

}  // namespace isowave::subdivision
