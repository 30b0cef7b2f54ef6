// Slices in picture files: folders of TIFF, PNG, BMP or JPEG files, and TIFF files whose pages are slices.
#pragma once

#include <filesystem>
#include <vector>

#include "io/image/source.h"

namespace isowave::imageio {

// Both throw InputError for what is wrong before voxels are read.
// path: a TIFF; one page alone, and any other picture, are refused as a 2D image.
SourcePtr openPictureFile(const std::filesystem::path& path, const ImageReadOptions& options);
// slices: files of one kind and one page, in order, or one TIFF of several pages. BMP and JPEG hold colours: those of a slice are grey,
// within what JPEG makes of grey. A warning says that JPEG is lossy.
SourcePtr openSliceFiles(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& slices, const ImageReadOptions& options);

}  // namespace isowave::imageio
