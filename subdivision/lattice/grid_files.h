// Height fields and grids of points, and the files that hold them.
#pragma once

#include <filesystem>
#include <string>

#include "isowave/subdivision.h"

namespace isowave::subdivision {

// By the name's end:
//   .npy              two axes (heights), or three with at most four channels last
//   .asc              ESRI ASCII grid
//   .png .tif .tiff   heights as stored; colours become their luminance
// io/picture says which kinds of each are read. Throws InputError: damaged, fewer than 2 rows or columns, samples that
// are transparent, without data or, unless `gaps` is true, not finite (how many, and where the first is).
Grid readGrid(const std::filesystem::path& path, bool gaps = false);

// NumPy, float64: shape (rows, columns) or (rows, columns, channels).
std::string npyBytes(const Grid& grid);
// 8-bit grey PNG of channel 0, from `black` to `white`, of which either may be the larger; what is not finite becomes
// white.
std::string pngBytes(const Grid& grid, double black, double white);

}  // namespace isowave::subdivision
