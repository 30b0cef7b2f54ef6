// Pictures as height fields: PNG by libpng, TIFF by ITK. The one header of this folder that needs
// `isowave::pictures`.
#pragma once

#include <filesystem>

#include "subdivision/lattice/grid_files.h"

namespace isowave::subdivision {

// .png .tif .tiff (8 and 16 bits, float TIFF; colours become their luminance); the rest by readGrid().
// Throws InputError when the file cannot be read, or has fewer than 2 rows or columns.
Grid readPictureOrGrid(const std::filesystem::path& path);

// 8-bit grey, values from `black` to `white` of channel 0 (either may be the larger); what is not finite becomes white.
std::string pngBytes(const Grid& grid, double black, double white);
// As a file, which appears whole or not at all. Throws OperationError when it cannot be written.
void writePng(const std::filesystem::path& path, const Grid& grid, double black, double white);

}  // namespace isowave::subdivision
