// --tiles: the levels in tiles, in a folder of their own beside the meshes.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "io/mesh/tiles/tile_writer.h"
#include "isowave/ladder.h"
#include "tools/command.h"
#include "tools/output.h"

namespace isowave::tools {

struct TileChoice {
    std::optional<TileFormat> format;

    void declare(OptionList& options);
    // Throws UsageError where there are no levels, each of which is twice as coarse as the one before.
    void requireLevels(const LevelOptions& levels, const BudgetOptions& budgets) const;
    // "part_neuroglancer", "part_3d-tiles". REQUIRES: format.
    std::string folderOf(const std::string& part) const;
    // Into that folder of `out`; nothing without --tiles. The segment is the label that was asked for, or 1.
    std::unique_ptr<TileWriter> writerFor(OutputFolder& out, const InputReport& input,
                                          const MeshWriteOptions& options) const;
};

void addTiles(TileWriter& tiles, const LevelReport& report, const TriangleMesh& mesh,
              const Progress& progress);

}  // namespace isowave::tools
