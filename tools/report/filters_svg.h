// Filters as a drawing.
#pragma once

#include <string>

#include "subdivision/filters/construct.h"

namespace isowave::tools {

// A page of four (or more) panels: fine mesh thin, coarse mesh thick, values in circles (vertex nodes are squares), blue
// for positive and red for negative, stronger where larger.
std::string svg(const subdivision::Filters& filters);
// One panel.
std::string svg(const subdivision::Diagram& diagram, subdivision::Lattice lattice, subdivision::Node centre,
                const std::string& title);

}  // namespace isowave::tools
