// TIFF volumes, which ITK reads, and folders of TIFF or PNG slices.
#pragma once

#include <filesystem>
#include <vector>

#include "io/image/source.h"

namespace isowave::imageio {

// Both throw InputError for what is wrong before voxels are read.
SourcePtr openVolumeFile(const std::filesystem::path& path);
// slices: TIFF or PNG files, in order.
SourcePtr openSliceFiles(const std::filesystem::path& folder,
                         const std::vector<std::filesystem::path>& slices);

}  // namespace isowave::imageio
