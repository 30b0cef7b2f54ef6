// Solids to and from packed files.
#pragma once

#include <filesystem>
#include <optional>

#include "compress/packed_file.h"
#include "isowave/pyramid.h"

namespace isowave::lod {

// Control points that unpacking has memory for: maxMemory as in SolidOptions.
double mostPackedPoints(const std::optional<double>& maxMemory);

// Says that level 0 is not what it was to the bit, where that is so. Throws as compress::readPacked() does.
compress::PackedField openPacked(const std::filesystem::path& path, const std::optional<double>& maxMemory,
                                 const Progress& progress);

// Of pyramids, to the bit. Throws as isowave::pack() does.
void packExactly(const BSplineField& field, const std::map<std::string, std::string>& source,
                 const std::filesystem::path& path);

}  // namespace isowave::lod
