// The tables of TIFF files, checked before libtiff reads the file.
#pragma once

#include <filesystem>

namespace isowave::imageio {

// Throws InputError where what the tables point to does not lie in the file.
void checkTiff(const std::filesystem::path& path);

}  // namespace isowave::imageio
