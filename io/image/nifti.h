// NIfTI headers, checked before the NIfTI library reads the file.
#pragma once

#include <filesystem>

#include "io/image/header.h"

namespace isowave::imageio {

// Throws InputError as header.h says.
HeaderFacts checkNifti(const std::filesystem::path& path);

}  // namespace isowave::imageio
