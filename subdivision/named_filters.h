// Filters by one name: what `isowave filters` shows.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "subdivision/filters/construct.h"

namespace isowave::subdivision {

// A mask's name (chaikin, cubic, dlg, butterfly, loop, catmull-clark), bspline-D, loop-like:ALPHA,GAMMA, or a
// scheme's (cubic-7, dlg-refined, butterfly-3, loop-1). Without a width: the scheme's own, else the usual one
// (chaikin 4, cubic 7, dlg 9, butterfly 3, the others their smallest). Throws InputError as namedMask() and
// construct() do.
Filters namedFilters(std::string_view name, std::optional<int> width);

// For a mask of one's own: this width, or the smallest there is.
Filters maskFilters(const Mask& mask, std::optional<int> width);

// The diagrams that differ from the interior's, as text: of a curve scheme the rows of A and B, the columns
// of P and Q beside an end; of Butterfly or Loop the rows of A and P on a side and one, two .. levels in.
// Throws InputError for a name that has no boundary rules.
std::string boundaryPictures(std::string_view name);

}  // namespace isowave::subdivision
