#include "io/mesh/tiles/write_tiles.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "io/mesh/tiles/neuroglancer.h"
#include "io/mesh/tiles/tiles_3d.h"
#include "isowave/error.h"

namespace isowave {
namespace fs = std::filesystem;
namespace {

// Beside its place until it is whole, and gone if it never is.
class FolderOnItsWay {
  public:
    explicit FolderOnItsWay(const fs::path& place)
        : place_(fs::absolute(place / "").parent_path()), hidden_(besides("part")) {}
    ~FolderOnItsWay() {
        std::error_code ignored;
        fs::remove_all(hidden_, ignored);
    }
    FolderOnItsWay(const FolderOnItsWay&) = delete;
    FolderOnItsWay& operator=(const FolderOnItsWay&) = delete;

    const fs::path& hidden() const { return hidden_; }
    // In the place of tiles that are there; they stay where this fails.
    void commit() {
        const fs::path old = besides("old");
        std::error_code error, ignored;
        const bool there = fs::exists(place_, ignored);
        if (there) fs::rename(place_, old, error);
        if (!error) fs::rename(hidden_, place_, error);
        if (error && there) fs::rename(old, place_, ignored);
        if (error)
            throw OperationError(place_.string(),
                                 "cannot put the finished tiles here (" + error.message() + ")");
        fs::remove_all(old, ignored);
    }

  private:
    fs::path besides(const char* what) const {
        return place_.parent_path() /
               ("." + place_.filename().string() + "." + what + "-" + std::to_string(::getpid()));
    }
    fs::path place_, hidden_;
};

constexpr const char* kMultilod = "neuroglancer_multilod_draco";

std::string bytesUpTo(const fs::path& file, std::streamsize most) {
    std::string bytes(static_cast<std::size_t>(most), '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.read(bytes.data(), most);
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    return bytes;
}

// tileset.json, L0, L1, ...; info, 7, 7.index.
bool isOfTiles(std::string name) {
    if (name == "tileset.json" || name == "info") return true;
    if (name.starts_with('L'))
        name.erase(0, 1);
    else if (name.ends_with(".index"))
        name.resize(name.size() - std::string(".index").size());
    return !name.empty() && name.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::unique_ptr<TileWriter> makeTileWriter(const fs::path& folder, TileFormat format,
                                           const TileOptions& options) {
    std::error_code error;
    if (!fs::create_directory(folder, error))
        throw OperationError(
            folder.string(),
            "cannot make this folder (" + (error ? error.message() : "something is in the way") + ")");
    if (format == TileFormat::neuroglancer) return std::make_unique<NeuroglancerTiles>(folder, options);
    return std::make_unique<Tiles3d>(folder, options);
}

bool mayBecomeTiles(const fs::path& folder) {
    std::error_code error;
    if (fs::is_empty(folder, error)) return true;
    const bool isMarked = fs::is_regular_file(folder / "tileset.json", error) ||
                          bytesUpTo(folder / "info", 4096).find(kMultilod) != std::string::npos;
    fs::directory_iterator entries(folder, error);
    if (!isMarked || error) return false;
    return std::all_of(fs::begin(entries), fs::end(entries), [](const fs::directory_entry& entry) {
        return isOfTiles(entry.path().filename().string());
    });
}

void writeTiles(const fs::path& folder, std::span<const TileLevel> levels, TileFormat format,
                const TileOptions& options, const Progress& progress) {
    std::error_code ignored;
    if (fs::exists(folder, ignored) && (!fs::is_directory(folder, ignored) || !mayBecomeTiles(folder)))
        throw OperationError(folder.string(),
                             "is there and is or holds something else than tiles; move it away");
    FolderOnItsWay way(folder);
    const auto writer = makeTileWriter(way.hidden(), format, options);
    for (const TileLevel& level : levels) writer->add(level.mesh, level.voxel, level.error, progress);
    writer->finish();
    way.commit();
}

}  // namespace isowave
