// DICOM: a folder of slices, or one file of several frames.
#pragma once

#include <filesystem>
#include <vector>

#include "io/image/source.h"

namespace isowave::imageio {

// Both throw InputError for what is wrong before voxels are read.
SourcePtr openDicomFile(const std::filesystem::path& path, const ImageReadOptions& options);
// files: the DICOM files of a folder, of any number of series; options.series picks one.
SourcePtr openDicomFolder(const std::filesystem::path& folder,
                          const std::vector<std::filesystem::path>& files, const ImageReadOptions& options);

}  // namespace isowave::imageio
