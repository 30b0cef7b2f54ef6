// The skeleton of a DICOM file, checked before GDCM reads it.
#pragma once

#include <filesystem>

namespace isowave::imageio {

// Throws InputError for a file that breaks off and for damage over which GDCM would end the program.
void checkDicom(const std::filesystem::path& path);

}  // namespace isowave::imageio
