// Readers of lines and polygons: svg, geojson, points.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// The curves of the file, which are the same again after they were put back into it; and its polygons, as `isowave curves`
// reads them.
std::vector<Target> vectorTargets();

}  // namespace isowave::fuzz
