// Diagrams for people: rows on the line, hexagonal pictures on the triangular lattice, in text and as SVG.
#pragma once

#include <string>

#include "subdivision/filters/construct.h"

namespace isowave::subdivision {

// The least common denominator of all values; 1 for an empty diagram.
Integer commonDenominator(const Diagram& diagram);

// On the line one row, "1/196 x  23  -92  63 [208] 63  -92  23": the value of `centre` stands in brackets. On
// the two other lattices one line a row of nodes, the topmost first; on the triangular one each row is moved
// by half a cell, so that neighbours stand as they do in the plane. Zeros inside are dots. Ends with a
// newline.
std::string picture(const Diagram& diagram, Lattice lattice, Node centre);

// P, A, B, Q of the filters, with what they are and how many products prove them.
std::string picture(const Filters& filters);

// The same as one JSON object: nodes, exact values as strings, doubles, the proof.
std::string json(const Filters& filters);

// A page of four (or more) panels: fine mesh thin, coarse mesh thick, values in circles (vertex nodes are
// squares), blue for positive and red for negative, stronger where larger.
std::string svg(const Filters& filters);
// One panel.
std::string svg(const Diagram& diagram, Lattice lattice, Node centre, const std::string& title);

}  // namespace isowave::subdivision
