#include "tools/solids/tiles/tile_choice.h"

#include <algorithm>
#include <cmath>

#include "io/mesh/tiles/write_tiles.h"
#include "isowave/error.h"
#include "tools/option_values.h"

namespace isowave::tools {
namespace {

// A label that is a whole number from 1 on.
std::uint64_t segmentOf(const InputReport& input) {
    const double label = input.label.value_or(0);
    return label >= 1 && label < 1e15 && std::floor(label) == label ? static_cast<std::uint64_t>(label) : 1;
}

double voxelOf(const LevelReport& report) {
    return std::cbrt(report.spacing[0] * report.spacing[1] * report.spacing[2]);
}

}  // namespace

void TileChoice::declare(OptionList& options) {
    options.value("--tiles", "neuroglancer|3d-tiles", "",
                  "also the levels in tiles, a folder: name_neuroglancer (multi-resolution mesh, Draco) or "
                  "name_3d-tiles (3D Tiles 1.1, GLB)",
                  [this](const std::string& v) {
                      format = choice<TileFormat>(
                          v, {{"neuroglancer", TileFormat::neuroglancer}, {"3d-tiles", TileFormat::tiles3d}});
                  });
}

void TileChoice::requireLevels(const LevelOptions& levels, const BudgetOptions& budgets) const {
    if (!format) return;
    if (levels.steps)
        throw UsageError("--tiles are twice as large from level to level, and steps are not; give --levels");
    if (budgets.any() && !levels.levels)
        throw UsageError("--tiles hold levels, and with a budget there are none; give --levels too");
}

std::string TileChoice::folderOf(const std::string& part) const {
    return part + (format == TileFormat::neuroglancer ? "_neuroglancer" : "_3d-tiles");
}

std::unique_ptr<TileWriter> TileChoice::writerFor(OutputFolder& out, const InputReport& input,
                                                  const MeshWriteOptions& options) const {
    if (!format) return nullptr;
    return makeTileWriter(out.placeFolder(folderOf(out.name()), mayBecomeTiles), *format,
                          {options.space, options.metresPerUnit, segmentOf(input)});
}

void addTiles(TileWriter& tiles, const LevelReport& report, const TriangleMesh& mesh,
              const Progress& progress) {
    double error = *std::max_element(report.spacing.begin(), report.spacing.end());
    if (report.maxToLevel0 && report.maxFromLevel0)
        error = std::max(*report.maxToLevel0, *report.maxFromLevel0);
    tiles.add(mesh, voxelOf(report), error, progress);
}

}  // namespace isowave::tools
