// FreeSurfer's MGH images, plain (.mgh) or compressed by gzip (.mgz):
// surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat.
#pragma once

#include <filesystem>

#include "io/image/formats/stored_volume.h"

namespace isowave::imageio {

// Throws InputError for what is no MGH header of version 1 and for element types that are not numbers. A header that does
// not say where voxels lie (goodRASFlag 0) means coronal slices of 1 mm, as FreeSurfer has it, with a remark.
StoredVolume readMghHeader(const std::filesystem::path& path);

}  // namespace isowave::imageio
