// TIFF files as volumes: pages are slices, of one channel and one time.
#pragma once

#include <filesystem>

#include "io/image/source.h"

namespace isowave::imageio {

// A file of one slice or more. The tables are checked, all pages are alike, nothing is decoded yet. Voxels are as
// stored: 1, 2 and 4 bits as uint8, halves as float32, places in a palette as labels.
// Throws InputError: truncated, damaged, colours, several channels or times of which options choose none, pages of other
// sizes or types (says which).
SourcePtr openTiffStack(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::imageio
