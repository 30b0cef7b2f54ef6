// Formats that are not read: what such a file is, and the command that makes a file of it that is read.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace isowave::imageio {

// "is a CAD model in STEP; make a mesh of it: gmsh part.step -2 -clcurv 12 -o part.stl"; nothing for what is not known. By the
// name, and by the header of INRIMAGE files, whose voxels are read when options say where they lie. path: a
// file, or a folder (BMP or JPEG slices).
std::optional<std::string> foreignText(const std::filesystem::path& path);

}  // namespace isowave::imageio
