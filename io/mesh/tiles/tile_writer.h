// A ladder of meshes -> a folder of tiles, a level at a time: what the writers of both formats have in common.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "isowave/ladder.h"
#include "isowave/progress.h"

namespace isowave {

class TileWriter {
  public:
    virtual ~TileWriter() = default;
    // Finest first, every voxel about twice the one before. voxel, error: world units, as TileLevel has them. A mesh without triangles
    // is a level without tiles. Throws OperationError, Cancelled.
    virtual void add(const TriangleMesh& mesh, double voxel, double error, const Progress& progress = {}) = 0;
    // What ties the tiles together. Throws OperationError; InputError where no mesh has a triangle.
    virtual void finish() = 0;
};

// A file of a folder that is not at its place yet. Throws OperationError.
class TileFile {
  public:
    explicit TileFile(std::filesystem::path path);
    void append(std::string_view bytes);
    void close();

  private:
    [[noreturn]] void fail() const;
    std::filesystem::path path_;
    std::ofstream stream_;
};
void writeTileFile(const std::filesystem::path& path, std::string_view bytes);

}  // namespace isowave
