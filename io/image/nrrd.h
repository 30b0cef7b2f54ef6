// NRRD headers, checked before NrrdIO reads the file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/image/header.h"

namespace isowave::imageio {

// Throws InputError as header.h says.
HeaderFacts checkNrrd(const std::filesystem::path& path);

// The files of the voxels as the header names them, relative to it: names, or one pattern with a %; nothing
// when the voxels are in the file itself. Throws InputError.
std::vector<std::string> nrrdVoxelFiles(const std::filesystem::path& path);

}  // namespace isowave::imageio
