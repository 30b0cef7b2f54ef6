// The pyramid's file: one .vdb with a grid for each part, which vdb_print lists. docs/interfaces.md, "pyramid
// file".
#pragma once

#include <filesystem>

#include "wavelets/pyramid.h"

namespace isowave::wavelets {

inline constexpr int kPyramidFormatVersion = 1;

// Temporary name, then rename. Throws OperationError.
void writePyramid(const std::filesystem::path& path, const Pyramid& pyramid);

// Throws InputError: missing, truncated, not a .vdb, not a pyramid, another format version, parts missing.
Pyramid readPyramid(const std::filesystem::path& path);

// Whether the file is a .vdb that calls itself a pyramid (reads the header only). False for anything else.
bool isPyramidFile(const std::filesystem::path& path);

}  // namespace isowave::wavelets
