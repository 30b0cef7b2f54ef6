#include "io/mesh/tiles/neuroglancer.h"

#include <nlohmann/json.hpp>
#include <unordered_map>

#include "io/mesh/place.h"
#include "io/mesh/tiles/draco_bytes.h"
#include "isowave/error.h"

namespace isowave {
namespace {

constexpr int kBits = 16;
constexpr std::int64_t kUnits = (1 << kBits) - 1;
constexpr double kNanometresPerMetre = 1e9;

template <class Number>
void append(std::string& bytes, Number value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

TilePlanes planesOf(std::size_t level) { return {kUnits, level > 0}; }

}  // namespace

NeuroglancerTiles::NeuroglancerTiles(const std::filesystem::path& folder, const TileOptions& options)
    : folder_(folder), options_(options), data_(folder / std::to_string(options.segment)) {}

void NeuroglancerTiles::add(const TriangleMesh& mesh, double voxel, double, const Progress& progress) {
    TriangleMesh placed{mesh.points, {}, {}};
    placeFor(MeshFormat::ply, {options_.space, options_.metresPerUnit}, placed);
    placed.triangles = mesh.triangles;
    if (!grid_ && !mesh.triangles.empty()) grid_ = gridAround(boxAround(placed), voxel);
    const std::size_t level = levels_.size();
    levels_.emplace_back(&zOrderLess);
    voxels_.push_back(static_cast<float>(voxel));
    if (mesh.triangles.empty()) return;
    std::vector<LatticePoint> points;
    for (const Point& p : placed.points)
        points.push_back(grid_->latticePointOf(p, static_cast<int>(level), kUnits));
    const ClippedMesh clipped = clipToPlanes(std::move(points), {}, placed.triangles, planesOf(level));
    for (const TileTriangles& tile : tilesOf(clipped, planesOf(level))) {
        progress.check();
        levels_.back()[tile.tile] = {appendFragment(clipped, tile), tile.octants};
    }
}

std::uint32_t NeuroglancerTiles::appendFragment(const ClippedMesh& mesh, const TileTriangles& tile) {
    std::vector<std::array<std::int32_t, 3>> points;
    std::vector<Triangle> triangles;
    std::unordered_map<std::uint32_t, std::uint32_t> numbers;
    for (const std::uint32_t t : tile.triangles) {
        Triangle& corners = triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.triangles[t][k];
            const auto [number, added] = numbers.try_emplace(v, static_cast<std::uint32_t>(points.size()));
            corners[k] = number->second;
            if (!added) continue;
            auto& p = points.emplace_back();
            for (std::size_t a = 0; a < 3; ++a)
                p[a] = static_cast<std::int32_t>(mesh.points[v][a] - tile.tile[a] * kUnits);
        }
    }
    const std::string bytes = dracoBytes(points, triangles);
    data_.append(bytes);
    return static_cast<std::uint32_t>(bytes.size());
}

// Fragments of no bytes: children that an octant is replaced by where it has triangles, from the top down; then parents, upwards.
void NeuroglancerTiles::completeTree() {
    for (std::size_t l = levels_.size(); l-- > 1;)
        for (const auto& [at, fragment] : levels_[l])
            for (int octant = 0; octant < 8; ++octant)
                if (fragment.octants >> octant & 1) levels_[l - 1].try_emplace(childOf(at, octant));
    for (std::size_t l = 0; l + 1 < levels_.size(); ++l)
        for (const auto& [at, fragment] : levels_[l]) levels_[l + 1].try_emplace(parentOf(at));
}

std::string NeuroglancerTiles::manifest() const {
    const std::int64_t shift = shiftOf(levels_);
    std::string bytes;
    for (int a = 0; a < 3; ++a) append(bytes, static_cast<float>(grid_->chunk));
    for (std::size_t a = 0; a < 3; ++a) {
        const double corner = grid_->corner[a] - static_cast<double>(shift) * grid_->chunk;
        if (static_cast<float>(corner) != corner)
            throw OperationError(
                "tiles", "the solid is too far from the origin for neuroglancer's float32; move it nearer");
        append(bytes, static_cast<float>(corner));
    }
    append(bytes, static_cast<std::uint32_t>(levels_.size()));
    for (const float voxel : voxels_) append(bytes, voxel);
    for (std::size_t i = 0; i < 3 * levels_.size(); ++i) append(bytes, 0.0f);  // vertex_offsets
    for (const auto& level : levels_) append(bytes, static_cast<std::uint32_t>(level.size()));
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        for (std::size_t a = 0; a < 3; ++a)
            for (const auto& [at, fragment] : levels_[l])
                append(bytes, static_cast<std::uint32_t>(at[a] + (shift >> l)));
        for (const auto& [at, fragment] : levels_[l]) append(bytes, fragment.bytes);
    }
    return bytes;
}

std::string NeuroglancerTiles::info() const {
    const double scale = options_.metresPerUnit * kNanometresPerMetre;
    const nlohmann::json json{{"@type", "neuroglancer_multilod_draco"},
                              {"vertex_quantization_bits", kBits},
                              {"transform", {scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0}},
                              {"lod_scale_multiplier", 1}};
    return json.dump() + "\n";
}

void NeuroglancerTiles::finish() {
    data_.close();
    if (!grid_) throw InputError("tiles", "no level has a triangle; nothing to write");
    completeTree();
    writeTileFile(folder_ / (std::to_string(options_.segment) + ".index"), manifest());
    writeTileFile(folder_ / "info", info());
}

}  // namespace isowave
