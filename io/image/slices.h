// Slices in picture files: folders of TIFF or PNG files, and TIFF files whose pages are slices.
#pragma once

#include <filesystem>
#include <vector>

#include "io/image/source.h"

namespace isowave::imageio {

// Both throw InputError for what is wrong before voxels are read.
// path: a TIFF; one page alone, and a PNG, are refused as a 2D image.
SourcePtr openPictureFile(const std::filesystem::path& path, const ImageReadOptions& options);
// slices: TIFF or PNG files of one page, in order, or one TIFF of several pages.
SourcePtr openSliceFiles(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& slices, const ImageReadOptions& options);

}  // namespace isowave::imageio
