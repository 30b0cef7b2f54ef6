// Opens an image of any format: a file, or a folder of slices.
#pragma once

#include <filesystem>

#include "io/image/source.h"

namespace isowave::imageio {

// Finds out what the path is, opens it and settles options.spacing (settleGeometry()). Throws InputError as
// readImage() does before it reads voxels.
SourcePtr openSource(const std::filesystem::path& path, const ImageReadOptions& options);

}  // namespace isowave::imageio
