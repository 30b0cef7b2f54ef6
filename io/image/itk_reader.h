// Images that ITK's readers know: NRRD, MetaImage, NIfTI, TIFF, PNG.
#pragma once

#include <filesystem>
#include <vector>

#include "io/image/source.h"

namespace isowave::imageio {

// Both throw InputError for what is wrong before voxels are read. A volume whose voxels need no decoding is
// handed over to openPlain().
SourcePtr openVolumeFile(const std::filesystem::path& path, const ImageReadOptions& options);
// slices: TIFF or PNG files, in order.
SourcePtr openSliceFiles(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& slices, const ImageReadOptions& options);

}  // namespace isowave::imageio
