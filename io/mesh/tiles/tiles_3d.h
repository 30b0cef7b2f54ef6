// 3D Tiles 1.1: tileset.json and a GLB a tile, an octree whose coarser tiles are replaced by their children.
//     https://docs.ogc.org/cs/22-025r4/22-025r4.html
//
// Metres. In the tileset z is up as it is in the mesh; GLBs are Y up, as glTF has it and a viewer of tiles turns them back.
// The root's transform takes the grid's corner to its place. The lattice has 2^22 steps a tile, a power of two of a metre each: a
// vertex relative to its tile's corner is exact in float32, and so is the sum of both in float64, so that a border vertex
// is the same number for both tiles.
//
// geometricError is the level's error, never below that of the level before; 0 at level 0. A tile whose part of the solid is gone at the
// level before gets one child without content, so that it is not the last word there.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "io/mesh/tiles/octree.h"
#include "io/mesh/tiles/tile_writer.h"

namespace isowave {

class Tiles3d : public TileWriter {
  public:
    Tiles3d(const std::filesystem::path& folder, const TileOptions& options);
    void add(const TriangleMesh& mesh, double voxel, double error, const Progress& progress) override;
    void finish() override;

  private:
    struct Content {
        std::string uri;  // "" where there is none
    };
    void writeTile(const ClippedMesh& mesh, const TileTriangles& tile, int level,
                   const std::string& uri) const;
    void countFromZero();
    // Tiles without content, up to a single one.
    void completeTree();
    nlohmann::json tileOf(int level, const TileIndex& at) const;
    double errorOf(int level) const;

    std::filesystem::path folder_;
    TileOptions options_;
    std::optional<TileGrid> grid_;  // metres, z up; once there is a triangle
    std::vector<double> errors_;    // metres
    std::vector<TileMap<Content>> levels_;
    std::int64_t shift_ = 0;  // of the indices of level 0
};

}  // namespace isowave
