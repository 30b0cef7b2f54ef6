// Neuroglancer's multi-resolution meshes, unsharded: info, ID.index (which fragments there are) and ID (the fragments).
//     https://github.com/google/neuroglancer/blob/master/src/datasource/precomputed/meshes.md
//
// A fragment's vertices are whole numbers from 0 to 65535, 65535 being the next fragment's 0: the lattice has 65535 steps a tile,
// and a border vertex is the same point for both. From level 1 on no triangle crosses the middle of its tile either, 32768, where
// neuroglancer tells octants apart: it replaces a tile's octants by finer tiles one by one.
//
// So that this replacement ends well, a fragment of no bytes stands for "nothing to draw" where an octant has triangles and the
// level before has none there, and where a fragment has no parent.
#pragma once

#include <optional>
#include <vector>

#include "io/mesh/tiles/octree.h"
#include "io/mesh/tiles/tile_writer.h"

namespace isowave {

class NeuroglancerTiles : public TileWriter {
  public:
    NeuroglancerTiles(const std::filesystem::path& folder, const TileOptions& options);
    void add(const TriangleMesh& mesh, double voxel, double error, const Progress& progress) override;
    void finish() override;

  private:
    struct Fragment {
        std::uint32_t bytes = 0;
        std::uint8_t octants = 0;
    };
    std::uint32_t appendFragment(const ClippedMesh& mesh, const TileTriangles& tile);
    void completeTree();
    std::string manifest() const;
    std::string info() const;

    std::filesystem::path folder_;
    TileOptions options_;
    TileFile data_;
    std::optional<TileGrid> grid_;  // once there is a triangle
    std::vector<float> voxels_;
    std::vector<TileMap<Fragment>> levels_;
};

}  // namespace isowave
