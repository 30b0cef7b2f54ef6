// MetaImage (itk.org/Wiki/MetaIO/Documentation): .mha, or .mhd with its voxels beside it, plain, compressed by zlib or as
// text, in one file, in a list of files or in files that a pattern with a number names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/image/formats/stored_volume.h"

namespace isowave::imageio {

// Coordinates are LPS, as ITK has them; TransformMatrix holds one axis after another; DistanceUnits counts for spacing and
// offset. Axes behind the third one are volumes to choose from. Throws InputError for what is no MetaImage header, several
// numbers a voxel, 2D images.
StoredVolume readMetaHeader(const std::filesystem::path& path);

// The files of the voxels as the header names them, relative to it; nothing when the voxels are in the file itself. Throws
// InputError.
std::vector<std::string> metaVoxelFiles(const std::filesystem::path& path);

}  // namespace isowave::imageio
