// Tiles written: isowave/ladder.h declares writeTiles(); here is what it and `isowave lod --tiles` stand on.
#pragma once

#include <filesystem>
#include <memory>

#include "io/mesh/tiles/tile_writer.h"

namespace isowave {

// folder: is made; must not be there. Files are written as they come: whoever wants all or nothing moves the folder to its place
// at the end.
std::unique_ptr<TileWriter> makeTileWriter(const std::filesystem::path& folder, TileFormat format,
                                           const TileOptions& options);

// Whether a folder is what a TileWriter has made, or empty: what may be replaced. One that holds anything else, too, is not.
bool mayBecomeTiles(const std::filesystem::path& folder);

}  // namespace isowave
