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

// F of K is a distance of so many voxels: of a distance fit its half-width, of any other what the slope at the surface says.
double voxelsPerKOf(const std::optional<FitSummary>& fit, const BSplineField& field, const std::string& name,
                    const Progress& progress);

// Of pyramids, to the bit. Throws as isowave::pack() does.
void packExactly(const BSplineField& field, const std::map<std::string, std::string>& source,
                 const std::filesystem::path& path);

}  // namespace isowave::lod
