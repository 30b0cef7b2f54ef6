// All levels of a mesh in one GLB: glTF's way to hand a viewer a ladder that it may choose from.
//
// The scene holds one node, the finest level; its extension MSFT_lod lists the nodes of the others, and
// extras.MSFT_screencoverage from which share of the picture's height on each is fine enough. A viewer without MSFT_lod shows
// the finest.
//     https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Vendor/MSFT_lod
// Quantized (KHR_mesh_quantization): positions as 16-bit numbers, 65,535 steps along the longest side of a level's box, so off by half
// a step at most, and normals as 8-bit ones; the node's scale and translation put them back. Not quantized: float32,
// relative to the middle of the box. With distances to level 0 every vertex has that (_DISTANCE_TO_LEVEL0, float32) and its
// colour, and one range of colours is that of all levels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

class GlbLods {
  public:
    // options: as writeMesh() takes them for GLB: metres, Y up.
    GlbLods(const MeshWriteOptions& options, bool quantized) : options_(options), quantized_(quantized) {}

    // Finest first. coverage: the share of the picture's height above which this level is wanted, falling from level to level.
    // distances: to level 0, world units, one a point, or none. REQUIRES: a triangle; finite points; distances at every level or at
    // none.
    void add(const std::string& name, const TriangleMesh& mesh, double coverage,
             std::vector<float> distances = {});
    // Appears whole or not at all. distanceRange: the distance of the last colour, world units; 0: the largest of all that were
    // added. Throws OperationError; InputError where nothing was added.
    void write(const std::filesystem::path& path, double distanceRange = 0) const;

  private:
    struct Level {
        std::string name;
        double coverage = 0;
        std::size_t vertices = 0, triangles = 0;
        bool normals = false;
        Point translation{};
        double step = 1;                      // metres
        std::array<double, 3> low{}, high{};  // of the stored positions
        std::vector<float> distances;
    };
    void putPositions(const TriangleMesh& placed, Level& level);
    void putNormals(const TriangleMesh& placed);
    double largestDistance() const;
    std::string description(double range) const;

    MeshWriteOptions options_;
    bool quantized_;
    std::vector<Level> levels_;
    std::string
        binary_;  // positions, normals, indices of each level in turn; distances and colours of all follow
};

}  // namespace isowave
