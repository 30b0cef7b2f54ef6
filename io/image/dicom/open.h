// DICOM: a folder of files, or one file of several frames.
//
// The geometry comes from the tags (frame.h), whatever the SOP class is, and frames are placed by the same code as
// slices (place.h). Uncompressed pixels are read here, compressed ones by GDCM in a child process (codec.h).
#pragma once

#include <filesystem>
#include <vector>

#include "io/image/source.h"

namespace isowave::imageio {

// Both throw InputError for what is wrong before voxels are read.
SourcePtr openDicomFile(const std::filesystem::path& path, const ImageReadOptions& options);
// files: the DICOM files of a folder, of any number of series; options.series and options.stack pick. Files that hold no
// image, and those that are no DICOM, are left out with a remark.
SourcePtr openDicomFolder(const std::filesystem::path& folder,
                          const std::vector<std::filesystem::path>& files, const ImageReadOptions& options);

}  // namespace isowave::imageio
