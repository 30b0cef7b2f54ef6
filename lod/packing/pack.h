// Solids to and from packed files.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "compress/packed_file.h"
#include "isowave/pyramid.h"
#include "wavelets/pyramid.h"

namespace isowave::lod {

// Control points that unpacking has memory for: maxMemory as in SolidOptions.
double mostPackedPoints(const std::optional<double>& maxMemory);

// What a packed solid has besides its field: the order of its steps, which the file keeps among its source's texts.
struct PackedSolid {
    BSplineField field;
    StepOrder order;
    std::map<std::string, std::string> source;
};

// Says that level 0 is not what it was to the bit, where that is so. Throws as compress::readPacked() does, and InputError for an
// order that is none.
PackedSolid openPacked(const std::filesystem::path& path, const std::optional<double>& maxMemory,
                       const Progress& progress);

// F of K is a distance of so many voxels: of a distance fit its half-width, of any other what the slope at the surface says.
double voxelsPerKOf(const std::optional<FitSummary>& fit, const BSplineField& field, const std::string& name,
                    const Progress& progress);

// Of pyramids, to the bit. Throws as isowave::pack() does.
void packExactly(const BSplineField& level0, const wavelets::Pyramid& pyramid,
                 const std::filesystem::path& path);

}  // namespace isowave::lod
