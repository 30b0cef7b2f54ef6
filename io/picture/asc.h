// ESRI ASCII grids (.asc): ncols, nrows, xll.., yll.., cellsize, NODATA_value, then the rows from the top.
#pragma once

#include <string>
#include <string_view>

#include "io/picture/picture.h"

namespace isowave {

// Where the grid lies and how large its cells are is passed over. `name` stands in messages. Throws InputError: no size
// or one beyond 2^20 a side, truncated, samples without data (how many, and where the first is).
Picture readAsc(std::string_view text, const std::string& name);

}  // namespace isowave
