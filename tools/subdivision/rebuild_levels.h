// rebuild of curves and of heights, whose details curve-levels and relief have written.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "isowave/subdivision.h"

namespace isowave::tools {

// What a file of details belongs to, by its first bytes.
enum class DetailsOf { meshes, curves, heights };
// Meshes also where it is no file of details, or cannot be read: their reader says so.
DetailsOf detailsOf(const std::filesystem::path& path);

struct LevelsRebuild {
    std::filesystem::path base, details, output;
    std::optional<std::filesystem::path> edited;  // in place of base
    std::optional<subdivision::Frames> frames;
    int depth = subdivision::kAllLevels;
    std::optional<double> threshold;
    std::optional<std::size_t> keep;
    subdivision::Positions positions = subdivision::Positions::control;
};

struct RebuiltLevels {
    std::string bytes;  // of the file
    subdivision::LevelsRebuildReport report;
};

// Both throw InputError, naming the file: a base that is not that of the details, an edited one of another size; UsageError:
// an output of another format, frames that have no meaning.
RebuiltLevels rebuildCurves(const LevelsRebuild& wanted);
RebuiltLevels rebuildHeights(const LevelsRebuild& wanted);

}  // namespace isowave::tools
