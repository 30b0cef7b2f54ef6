// Filters for people: rows on the line, hexagonal pictures on the triangular lattice, and JSON (docs/interfaces.md).
#pragma once

#include <string>
#include <vector>

#include "subdivision/filter_catalogue.h"
#include "tools/report/json.h"

namespace isowave::tools {

// On the line one row, "1/196 x  23  -92  63 [208] 63  -92  23": the value of `centre` stands in brackets. On the two
// other lattices one line a row of nodes, the topmost first; on the triangular one each row is moved by half a cell, so
// that neighbours stand as they do in the plane. Zeros inside are dots. Ends with a newline.
std::string picture(const subdivision::Diagram& diagram, subdivision::Lattice lattice,
                    subdivision::Node centre);

// P, A, B, Q of the filters, with what they are and how many products prove them.
std::string textOf(const subdivision::Filters& filters, const subdivision::Proof& proof);
// The same: nodes, exact values as strings, doubles, the proof.
std::string jsonOf(const subdivision::Filters& filters, const subdivision::Proof& proof);

// The diagrams that differ from the interior's.
std::string textOf(const subdivision::BoundaryFilters& filters);

// The diagrams in the order in which they are shown, with the node each is centred on. They point into `filters`.
struct NamedDiagram {
    std::string title;
    const subdivision::Diagram* diagram;
    subdivision::Node centre;
};
std::vector<NamedDiagram> namedDiagrams(const subdivision::Filters& filters);

}  // namespace isowave::tools
