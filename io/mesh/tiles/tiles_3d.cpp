#include "io/mesh/tiles/tiles_3d.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "io/mesh/glb.h"
#include "io/mesh/place.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::int64_t kUnits = std::int64_t{1} << 22;  // float32 has 24 bits
constexpr TilePlanes kPlanes{kUnits, false};

template <class Vector>
Vector yUp(const Vector& p) {
    return {p[0], p[2], -p[1] + 0};
}

// Metres, z up, in the axes that were asked for.
TriangleMesh inMetres(const TriangleMesh& mesh, const TileOptions& options) {
    TriangleMesh placed{mesh.points, {}, mesh.normals};
    placeFor(MeshFormat::ply, {options.space, options.metresPerUnit}, placed);
    for (Point& p : placed.points)
        for (double& x : p) x *= options.metresPerUnit;
    placed.triangles = mesh.triangles;
    return placed;
}

std::string uriOf(int level, const TileIndex& at) {
    return "L" + std::to_string(level) + "/" + std::to_string(at[0]) + "_" + std::to_string(at[1]) + "_" +
           std::to_string(at[2]) + ".glb";
}

void makeFolder(const fs::path& folder) {
    std::error_code error;
    if (!fs::create_directory(folder, error))
        throw OperationError(folder.string(), "cannot make this folder (" + error.message() + ")");
}

}  // namespace

Tiles3d::Tiles3d(const fs::path& folder, const TileOptions& options) : folder_(folder), options_(options) {}

void Tiles3d::add(const TriangleMesh& mesh, double voxel, double error, const Progress& progress) {
    const double before = errors_.empty() ? 0 : errors_.back();
    errors_.push_back(levels_.empty() ? 0 : std::max(before, error * options_.metresPerUnit));
    const auto level = static_cast<int>(levels_.size());
    levels_.emplace_back(&zOrderLess);
    if (mesh.triangles.empty()) return;
    TriangleMesh placed = inMetres(mesh, options_);
    if (!grid_) grid_ = gridAround(boxAround(placed), voxel * options_.metresPerUnit);
    std::vector<LatticePoint> points;
    for (const Point& p : placed.points) points.push_back(grid_->latticePointOf(p, level, kUnits));
    const ClippedMesh clipped =
        clipToPlanes(std::move(points), std::move(placed.normals), placed.triangles, kPlanes);
    makeFolder(folder_ / ("L" + std::to_string(level)));
    for (const TileTriangles& tile : tilesOf(clipped, kPlanes)) {
        progress.check();
        const std::string uri = uriOf(level, tile.tile);
        writeTile(clipped, tile, level, uri);
        levels_.back()[tile.tile] = {uri};
    }
}

void Tiles3d::writeTile(const ClippedMesh& mesh, const TileTriangles& tile, int level,
                        const std::string& uri) const {
    TriangleMesh own;
    std::unordered_map<std::uint32_t, std::uint32_t> numbers;
    const Point corner = TileGrid{{}, grid_->chunk}.cornerOf(level, tile.tile);  // from the grid's
    const double step = grid_->side(level) / static_cast<double>(kUnits);
    for (const std::uint32_t t : tile.triangles) {
        Triangle& corners = own.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.triangles[t][k];
            const auto [number, added] =
                numbers.try_emplace(v, static_cast<std::uint32_t>(own.points.size()));
            corners[k] = number->second;
            if (!added) continue;
            Point p{};
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = static_cast<double>(mesh.points[v][a] - tile.tile[a] * kUnits) * step;
            own.points.push_back(yUp(p));
            if (!mesh.normals.empty()) own.normals.push_back(yUp(mesh.normals[v]));
        }
    }
    MeshView view;
    view.points = own.points;
    view.normals = own.normals;
    view.triangles = own.triangles;
    view.space = options_.space;
    Sink sink;
    writeGlbAround(sink, view, (folder_ / uri).string(), uri.substr(0, uri.size() - 4), yUp(corner));
    writeTileFile(folder_ / uri, sink.take());
}

// Tiles keep their names and places; only the indices rise, so that the tree has one root.
void Tiles3d::countFromZero() {
    shift_ = shiftOf(levels_);
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        TileMap<Content> shifted(&zOrderLess);
        for (const auto& [at, content] : levels_[l]) {
            TileIndex to = at;
            for (std::int32_t& x : to) x += static_cast<std::int32_t>(shift_ >> l);
            shifted[to] = content;
        }
        levels_[l] = std::move(shifted);
    }
}

void Tiles3d::completeTree() {
    for (std::size_t l = 1; l < levels_.size(); ++l)
        for (const auto& [at, content] : levels_[l - 1]) levels_[l].try_emplace(parentOf(at));
    for (std::size_t l = 1; l < levels_.size(); ++l)
        for (const auto& [at, content] : levels_[l]) {
            bool anyChild = false;
            for (int octant = 0; octant < 8; ++octant)
                anyChild |= levels_[l - 1].count(childOf(at, octant)) > 0;
            if (!anyChild) levels_[l - 1].try_emplace(childOf(at, 0));
        }
    while (levels_.back().size() > 1) {
        TileMap<Content> parents(&zOrderLess);
        for (const auto& [at, content] : levels_.back()) parents.try_emplace(parentOf(at));
        levels_.push_back(std::move(parents));
    }
}

// Above the ladder's levels nothing is drawn, wherefore all that there is is missing.
double Tiles3d::errorOf(int level) const {
    if (level < static_cast<int>(errors_.size())) return errors_[static_cast<std::size_t>(level)];
    return std::max(errors_.back(), std::sqrt(3.0) * grid_->side(level));
}

json Tiles3d::tileOf(int level, const TileIndex& at) const {
    const double before = -static_cast<double>(shift_) * grid_->chunk;
    const Point corner = TileGrid{{before, before, before}, grid_->chunk}.cornerOf(level, at);
    const double half = grid_->side(level) / 2;
    json tile{
        {"boundingVolume",
         {{"box",
           {corner[0] + half, corner[1] + half, corner[2] + half, half, 0, 0, 0, half, 0, 0, 0, half}}}},
        {"geometricError", errorOf(level)},
        {"refine", "REPLACE"}};
    const auto& content = levels_[static_cast<std::size_t>(level)].at(at);
    if (!content.uri.empty()) tile["content"]["uri"] = content.uri;
    if (level == 0) return tile;
    const auto& below = levels_[static_cast<std::size_t>(level - 1)];
    for (int octant = 0; octant < 8; ++octant)
        if (below.count(childOf(at, octant)))
            tile["children"].push_back(tileOf(level - 1, childOf(at, octant)));
    return tile;
}

void Tiles3d::finish() {
    if (!grid_) throw InputError("tiles", "no level has a triangle; nothing to write");
    countFromZero();
    completeTree();
    const auto top = static_cast<int>(levels_.size()) - 1;
    json root = tileOf(top, levels_.back().begin()->first);
    const Point& c = grid_->corner;
    root["transform"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, c[0], c[1], c[2], 1};
    json tileset{{"asset", {{"version", "1.1"}, {"generator", "isowave"}}},
                 {"geometricError", std::max(errorOf(top), std::sqrt(3.0) * grid_->side(top))},
                 {"root", root}};
    if (options_.space != Space::unspecified)
        tileset["asset"]["extras"]["SPACE"] = options_.space == Space::lps ? "LPS" : "RAS";
    writeTileFile(folder_ / "tileset.json", tileset.dump() + "\n");
}

}  // namespace isowave
