// Tiles are read back by readers of a few lines, which share nothing with the writers but Draco, and put together again.
#include <draco/compression/decode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "io/mesh/tiles/clip.h"
#include "io/mesh/tiles/octree.h"
#include "isowave/error.h"
#include "isowave/ladder.h"
#include "isowave/measure.h"
#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "temp_folder.h"

namespace isowave {
namespace {

using namespace isowave::testing;
using test::TempFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;
using nlohmann::json;

std::string bytesOf(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    EXPECT_TRUE(file) << path;
    return {std::istreambuf_iterator<char>(file), {}};
}

template <class T>
T at(const std::string& bytes, std::size_t place) {
    T value{};
    EXPECT_LE(place + sizeof value, bytes.size());
    if (place + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + place, sizeof value);
    return value;
}

// A tile's triangles as corners in the world, and the cube that it must not leave.
struct ReadTile {
    TileIndex at{};
    Point low{};
    double side = 0;
    std::vector<std::array<Point, 3>> triangles;
    std::size_t bytes = 0;
};
struct ReadLevel {
    std::vector<ReadTile> tiles;
    double scale = 0;  // neuroglancer's lod_scale, 3D Tiles' geometricError
};

// Corners at exactly one place are one vertex.
TriangleMesh welded(const ReadLevel& level) {
    TriangleMesh mesh;
    std::map<Point, std::uint32_t> numbers;
    for (const ReadTile& tile : level.tiles)
        for (const auto& triangle : tile.triangles) {
            Triangle& t = mesh.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [found, added] =
                    numbers.try_emplace(triangle[k], static_cast<std::uint32_t>(mesh.points.size()));
                t[k] = found->second;
                if (added) mesh.points.push_back(triangle[k]);
            }
        }
    return mesh;
}

// ---- neuroglancer, as meshes.md says

std::vector<std::array<std::int32_t, 3>> decoded(const std::string& bytes, std::vector<Triangle>& triangles) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    EXPECT_TRUE(mesh.ok()) << mesh.status().error_msg_string();
    if (!mesh.ok()) return {};
    const draco::PointAttribute* const position =
        mesh.value()->GetNamedAttribute(draco::GeometryAttribute::POSITION);
    // What neuroglancer's decoder asks for.
    EXPECT_EQ(position->data_type(), draco::DT_INT32);
    EXPECT_EQ(position->size(), mesh.value()->num_points());
    std::vector<std::array<std::int32_t, 3>> points(mesh.value()->num_points());
    for (std::uint32_t i = 0; i < points.size(); ++i)
        position->GetMappedValue(draco::PointIndex(i), points[i].data());
    for (std::uint32_t f = 0; f < mesh.value()->num_faces(); ++f) {
        const auto& face = mesh.value()->face(draco::FaceIndex(f));
        triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
    }
    return points;
}

// The corners in world units are exact: 65535 steps a tile, counted from the grid's origin.
std::vector<ReadLevel> readNeuroglancer(const fs::path& folder, const std::string& id = "1") {
    const std::string index = bytesOf(folder / (id + ".index")), data = bytesOf(folder / id);
    const json info = json::parse(bytesOf(folder / "info"));
    EXPECT_EQ(info["@type"], "neuroglancer_multilod_draco");
    EXPECT_EQ(info["vertex_quantization_bits"], 16);
    EXPECT_EQ(info["lod_scale_multiplier"], 1);
    const double chunk = at<float>(index, 0);
    Point origin{};
    for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_EQ(at<float>(index, 4 * a), chunk);
        origin[a] = at<float>(index, 12 + 4 * a);
    }
    const auto count = at<std::uint32_t>(index, 24);
    std::vector<ReadLevel> levels(count);
    std::size_t place = 28 + 16 * count, offset = 0;
    for (std::size_t l = 0; l < count; ++l) {
        levels[l].scale = at<float>(index, 28 + 4 * l);
        for (std::size_t a = 0; a < 3; ++a) EXPECT_EQ(at<float>(index, 28 + 4 * count + 12 * l + 4 * a), 0);
        const std::size_t fragments = at<std::uint32_t>(index, place + 4 * l - 0);
        levels[l].tiles.resize(fragments);
    }
    place += 4 * count;
    for (std::size_t l = 0; l < count; ++l) {
        std::vector<ReadTile>& tiles = levels[l].tiles;
        const std::size_t n = tiles.size();
        for (std::size_t f = 0; f < n; ++f) {
            ReadTile& tile = tiles[f];
            tile.side = std::ldexp(chunk, static_cast<int>(l));
            for (std::size_t a = 0; a < 3; ++a) {
                tile.at[a] = static_cast<std::int32_t>(at<std::uint32_t>(index, place + 4 * (a * n + f)));
                tile.low[a] = origin[a] + tile.at[a] * tile.side;
            }
            tile.bytes = at<std::uint32_t>(index, place + 4 * (3 * n + f));
            if (tile.bytes > 0) {
                std::vector<Triangle> triangles;
                const auto points = decoded(data.substr(offset, tile.bytes), triangles);
                for (const Triangle& t : triangles) {
                    auto& corners = tile.triangles.emplace_back();
                    for (std::size_t k = 0; k < 3; ++k)
                        for (std::size_t a = 0; a < 3; ++a) {
                            const std::int64_t x = points[t[k]][a];
                            EXPECT_TRUE(0 <= x && x <= 65535) << x;
                            corners[k][a] =
                                origin[a] +
                                static_cast<double>(65535 * std::int64_t{tile.at[a]} + x) * tile.side / 65535;
                        }
                }
            }
            offset += tile.bytes;
        }
        place += 16 * n;
    }
    EXPECT_EQ(place, index.size());
    EXPECT_EQ(offset, data.size());
    return levels;
}

// ---- 3D Tiles

struct TreeTile {
    int depth = 0;
    double error = 0;
    Point centre{};
    double half = 0;
    bool content = false;
    std::size_t children = 0;
};

class TilesetReader {
  public:
    explicit TilesetReader(const fs::path& folder)
        : folder_(folder), tileset(json::parse(bytesOf(folder / "tileset.json"))) {
        EXPECT_EQ(tileset["asset"]["version"], "1.1");
        const json& m = tileset["root"]["transform"];
        for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(m[k], k % 5 == 0 ? 1 : 0);
        for (std::size_t a = 0; a < 3; ++a) origin_[a] = m[12 + a];
        EXPECT_GE(tileset["geometricError"].get<double>(), tileset["root"]["geometricError"].get<double>());
        walk(tileset["root"], 0, nullptr);
    }
    std::map<int, ReadLevel> levels;  // by the number in the name of the tiles' folder
    std::vector<TreeTile> tree;

  private:
    void walk(const json& tile, int depth, const TreeTile* parent) {
        TreeTile here;
        here.depth = depth;
        here.error = tile["geometricError"];
        const json& box = tile["boundingVolume"]["box"];
        here.half = box[3];
        for (std::size_t a = 0; a < 3; ++a) here.centre[a] = box[a].get<double>() + origin_[a];
        for (std::size_t k = 3; k < 12; ++k) EXPECT_EQ(box[k], (k - 3) % 4 == 0 ? here.half : 0.0);
        EXPECT_EQ(tile["refine"], "REPLACE");
        here.content = tile.contains("content");
        here.children = tile.contains("children") ? tile["children"].size() : 0;
        if (parent) {
            EXPECT_LE(here.error, parent->error);
            EXPECT_EQ(2 * here.half, parent->half);
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_EQ(std::abs(here.centre[a] - parent->centre[a]), here.half);
        }
        if (here.content) readContent(tile["content"]["uri"], here);
        tree.push_back(here);
        if (tile.contains("children"))
            for (const json& child : tile["children"]) walk(child, depth + 1, &here);
    }
    void readContent(const std::string& uri, const TreeTile& here) {
        const std::string glb = bytesOf(folder_ / uri);
        EXPECT_EQ(glb.substr(0, 4), "glTF");
        const auto length = at<std::uint32_t>(glb, 12);
        const json gltf = json::parse(glb.substr(20, length));
        const std::string binary = glb.substr(28 + length);
        const json& primitive = gltf["meshes"][0]["primitives"][0];
        const auto start = [&](const json& accessor) {
            return gltf["bufferViews"][gltf["accessors"][accessor.get<int>()]["bufferView"].get<int>()]
                       ["byteOffset"]
                           .get<std::size_t>();
        };
        EXPECT_TRUE(primitive["attributes"].contains("NORMAL"));
        const std::size_t points = start(primitive["attributes"]["POSITION"]),
                          indices = start(primitive["indices"]);
        Point move{};
        if (gltf["nodes"][0].contains("translation")) move = gltf["nodes"][0]["translation"].get<Point>();
        ReadTile tile;
        tile.side = 2 * here.half;
        for (std::size_t a = 0; a < 3; ++a) tile.low[a] = here.centre[a] - here.half;
        const auto count = gltf["accessors"][primitive["indices"].get<int>()]["count"].get<std::size_t>();
        for (std::size_t i = 0; i < count; i += 3) {
            auto& corners = tile.triangles.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const auto v = at<std::uint32_t>(binary, indices + 4 * (i + k));
                Point p{};
                for (std::size_t a = 0; a < 3; ++a)
                    p[a] = move[a] + at<float>(binary, points + 12 * v + 4 * a);
                corners[k] = {p[0] + origin_[0], -p[2] + origin_[1], p[1] + origin_[2]};
            }
        }
        ReadLevel& level = levels[std::stoi(uri.substr(1))];
        level.scale = here.error;
        level.tiles.push_back(tile);
    }
    fs::path folder_;
    Point origin_{};

  public:
    json tileset;
};

// ---- the solids: levels of their own field, each of twice the spacing

// A torus in voxels of `spacing`.
TriangleMesh torusMesh(double across, double tube, double spacing, const Vec3d& origin) {
    auto transform = openvdb::math::Transform::createLinearTransform(spacing);
    transform->postTranslate(origin);
    const int reach = static_cast<int>((across + tube) / spacing) + 6;
    return polygonize(fieldFromDistance(reach, torus(across / spacing, tube / spacing), transform));
}

struct Ladder3 {
    std::string name;
    std::vector<TileLevel> levels;
};
// A ring far from the middle of the grid, and one around the world's origin.
Ladder3 ring(const Vec3d& origin) {
    Ladder3 ladder{"ring", {}};
    for (const double s : {1.0, 2.0, 4.0})
        ladder.levels.push_back({torusMesh(20, 7, s, origin), s / 8, s == 1 ? 0 : s / 3});
    return ladder;
}
Ladder3 noise() {
    Ladder3 ladder{"noise", {}};
    ladder.levels.push_back({polygonize(noiseField(14, 7)), 1.0 / 16, 0});
    ladder.levels.push_back({polygonize(noiseField(14, 8)), 1.0 / 8, 0.5});
    return ladder;
}
std::vector<Ladder3> ladders() {
    std::vector<Ladder3> all{ring(Vec3d(0)), ring(Vec3d(1234.3, -777.7, 31.1)), noise()};
    all[1].name = "far ring";
    return all;
}

// ---- what both formats promise

void expectSameSurface(const TriangleMesh& whole, const TriangleMesh& was, double step) {
    const MeshTopology now = topologyOf(whole), before = topologyOf(was);
    EXPECT_TRUE(now.closed());
    EXPECT_TRUE(now.manifold()) << now.nonManifoldEdges << ' ' << now.nonManifoldVertices;
    EXPECT_TRUE(now.oriented());
    EXPECT_EQ(now.components, before.components);
    EXPECT_EQ(now.genus, before.genus);
    EXPECT_NEAR(now.volume, before.volume, step * before.area);
    EXPECT_GE(now.triangles, before.triangles);
}

TEST(NeuroglancerTiles, WeldToTheMeshThatWasCut) {
    for (const Ladder3& ladder : ladders()) {
        SCOPED_TRACE(ladder.name);
        const TempFolder folder;
        writeTiles(folder / "tiles", ladder.levels, TileFormat::neuroglancer);
        const std::vector<ReadLevel> levels = readNeuroglancer(folder / "tiles");
        ASSERT_EQ(levels.size(), ladder.levels.size());
        for (std::size_t l = 0; l < levels.size(); ++l) {
            SCOPED_TRACE(l);
            EXPECT_EQ(levels[l].scale, ladder.levels[l].voxel);
            EXPECT_GE(levels[l].tiles.size(), 7u);
            expectSameSurface(welded(levels[l]), ladder.levels[l].mesh, levels[l].tiles[0].side / 65535);
            if (ladder.name == "far ring") {  // whose lattice is not the tiles'
                EXPECT_GT(welded(levels[l]).triangles.size(), ladder.levels[l].mesh.triangles.size());
            }
        }
    }
}

// From level 1 on also the middle, which is 32768 of 65535.
TEST(NeuroglancerTiles, NoTriangleCrossesThePlanes) {
    for (const Ladder3& ladder : ladders()) {
        const TempFolder folder;
        writeTiles(folder / "tiles", ladder.levels, TileFormat::neuroglancer);
        const std::vector<ReadLevel> levels = readNeuroglancer(folder / "tiles");
        for (std::size_t l = 1; l < levels.size(); ++l)
            for (const ReadTile& tile : levels[l].tiles)
                for (const auto& triangle : tile.triangles)
                    for (std::size_t a = 0; a < 3; ++a) {
                        bool below = false, above = false;
                        for (const Point& p : triangle) {
                            const auto x = std::llround((p[a] - tile.low[a]) / tile.side * 65535);
                            below |= x < 32768;
                            above |= x > 32768;
                        }
                        EXPECT_FALSE(below && above);
                    }
    }
}

// Neuroglancer builds its octree by walking both lists at once: in Z-order, each fragment with its parent. And an octant
// that has triangles has a child, if only an empty one.
TEST(NeuroglancerTiles, AreAWholeTreeInZOrder) {
    Ladder3 ladder = ring(Vec3d(0));
    ladder.levels[2].mesh = torusMesh(31, 5, 4, Vec3d(0));  // bulges: finer tiles are missing there
    const TempFolder folder;
    writeTiles(folder / "tiles", ladder.levels, TileFormat::neuroglancer);
    const std::vector<ReadLevel> levels = readNeuroglancer(folder / "tiles");
    std::size_t empty = 0;
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const auto zOf = [](const TileIndex& t) {
            std::uint64_t z = 0;
            for (int bit = 0; bit < 20; ++bit)
                for (std::size_t a = 0; a < 3; ++a)
                    z |= static_cast<std::uint64_t>(t[a] >> bit & 1) << (3 * bit + static_cast<int>(a));
            return z;
        };
        std::set<TileIndex> here, parents;
        for (std::size_t i = 0; i < levels[l].tiles.size(); ++i) {
            const ReadTile& tile = levels[l].tiles[i];
            if (i > 0) {
                EXPECT_LT(zOf(levels[l].tiles[i - 1].at), zOf(tile.at));
            }
            empty += tile.bytes == 0;
        }
        if (l + 1 == levels.size()) continue;
        for (const ReadTile& tile : levels[l].tiles) here.insert(tile.at);
        for (const ReadTile& tile : levels[l + 1].tiles) {
            parents.insert(tile.at);
            for (const auto& triangle : tile.triangles) {
                TileIndex child{};
                for (std::size_t a = 0; a < 3; ++a) {
                    double middle = 0;
                    for (const Point& p : triangle) middle += (p[a] - tile.low[a]) / tile.side / 3;
                    child[a] = 2 * tile.at[a] + (middle > 32768.0 / 65535 ? 1 : 0);
                }
                EXPECT_TRUE(here.count(child));
            }
        }
        for (const TileIndex& t : here) EXPECT_TRUE(parents.count(parentOf(t)));
    }
    EXPECT_GT(empty, 0u);
}

TEST(NeuroglancerTiles, SayTheUnitAndTheSegment) {
    const TempFolder folder;
    writeTiles(folder / "mm", ring(Vec3d(0)).levels, TileFormat::neuroglancer, {.segment = 417});
    const json info = json::parse(bytesOf(folder / "mm/info"));
    EXPECT_THAT(info["transform"].get<std::vector<double>>(),
                ElementsAre(1e6, 0, 0, 0, 0, 1e6, 0, 0, 0, 0, 1e6, 0));
    EXPECT_EQ(readNeuroglancer(folder / "mm", "417").size(), 3u);
    writeTiles(folder / "m", ring(Vec3d(0)).levels, TileFormat::neuroglancer, {.metresPerUnit = 1});
    EXPECT_EQ(json::parse(bytesOf(folder / "m/info"))["transform"][0], 1e9);
}

TEST(NeuroglancerTiles, TooFarForFloat32AreRefused) {
    const TempFolder folder;
    Ladder3 ladder = ring(Vec3d(0));
    for (TileLevel& level : ladder.levels)
        for (Point& p : level.mesh.points) p[0] += 1e9;
    EXPECT_THROW(writeTiles(folder / "tiles", ladder.levels, TileFormat::neuroglancer), OperationError);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

// 3D Tiles: in metres, here of units that are metres.
constexpr TileOptions kMetres{Space::unspecified, 1.0, 1};

TEST(Tiles3d, WeldToTheMeshThatWasCut) {
    for (const Ladder3& ladder : ladders()) {
        SCOPED_TRACE(ladder.name);
        const TempFolder folder;
        writeTiles(folder / "tiles", ladder.levels, TileFormat::tiles3d, kMetres);
        const TilesetReader read(folder / "tiles");
        ASSERT_EQ(read.levels.size(), ladder.levels.size());
        for (const auto& [l, level] : read.levels) {
            SCOPED_TRACE(l);
            const double step = level.tiles[0].side / (1 << 22);
            expectSameSurface(welded(level), ladder.levels[static_cast<std::size_t>(l)].mesh, step);
        }
    }
}

TEST(Tiles3d, NoTriangleLeavesItsTile) {
    for (const Ladder3& ladder : ladders()) {
        const TempFolder folder;
        writeTiles(folder / "tiles", ladder.levels, TileFormat::tiles3d, kMetres);
        for (const auto& [l, level] : TilesetReader(folder / "tiles").levels)
            for (const ReadTile& tile : level.tiles)
                for (const auto& triangle : tile.triangles)
                    for (const Point& p : triangle)
                        for (std::size_t a = 0; a < 3; ++a) {
                            EXPECT_GE(p[a], tile.low[a]);
                            EXPECT_LE(p[a], tile.low[a] + tile.side);
                        }
    }
}

// The reader checks that boxes are nested octants and errors fall.
TEST(Tiles3d, AreOneTreeOfOctants) {
    Ladder3 ladder = ring(Vec3d(0));
    ladder.levels[2].mesh = torusMesh(31, 5, 4, Vec3d(0));
    const TempFolder folder;
    writeTiles(folder / "tiles", ladder.levels, TileFormat::tiles3d, kMetres);
    const TilesetReader read(folder / "tiles");
    EXPECT_EQ(read.levels.at(0).scale, 0);
    EXPECT_EQ(read.levels.at(1).scale, 2.0 / 3);
    EXPECT_EQ(read.levels.at(2).scale, 4.0 / 3);
    int lastOfCoarse = 0, empty = 0;
    for (const TreeTile& tile : read.tree) {
        // A coarse tile that no finer one replaces would stay for ever.
        lastOfCoarse += tile.content && tile.children == 0 && tile.error > 0;
        empty += !tile.content && tile.children == 0;
    }
    EXPECT_EQ(lastOfCoarse, 0);
    EXPECT_GT(empty, 0);
    std::size_t contents = 0;
    for (const auto& [l, level] : read.levels) contents += level.tiles.size();
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder / "tiles"))
        files += entry.path().extension() == ".glb";
    EXPECT_EQ(contents, files);
}

TEST(Tiles3d, AreInMetresWithZUpAndTheirSpaceIsNamed) {
    const TempFolder folder;
    const Ladder3 ladder = ring(Vec3d(1000, 0, 0));
    writeTiles(folder / "tiles", ladder.levels, TileFormat::tiles3d, {Space::ras, 0.001, 1});
    const TilesetReader read(folder / "tiles");
    EXPECT_EQ(read.tileset["asset"]["extras"]["SPACE"], "RAS");
    Point low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    for (const Point& p : welded(read.levels.at(0)).points)
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    Point lowest = ladder.levels[0].mesh.points[0], highest = lowest;
    for (const Point& p : ladder.levels[0].mesh.points)
        for (std::size_t a = 0; a < 3; ++a) {
            lowest[a] = std::min(lowest[a], p[a]);
            highest[a] = std::max(highest[a], p[a]);
        }
    EXPECT_NEAR(low[0], -highest[0] / 1000, 1e-7);
    EXPECT_NEAR(high[0], -lowest[0] / 1000, 1e-7);
    EXPECT_NEAR(low[1], -highest[1] / 1000, 1e-7);
    EXPECT_NEAR(low[2], lowest[2] / 1000, 1e-7);
    EXPECT_NEAR(high[2], highest[2] / 1000, 1e-7);
}

// ---- folders

class TileFolder : public ::testing::TestWithParam<TileFormat> {};

TEST_P(TileFolder, IsReplacedAsAWholeAndNothingIsLeftBeside) {
    const TempFolder folder;
    writeTiles(folder / "tiles", ring(Vec3d(0)).levels, GetParam());
    std::ofstream(folder / "tiles/99") << "x";  // as of another segment
    writeTiles(folder / "tiles/", noise().levels, GetParam());
    EXPECT_FALSE(fs::exists(folder / "tiles/99"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
}

TEST_P(TileFolder, OfSomethingElseIsRefused) {
    const TempFolder folder;
    fs::create_directory(folder / "tiles");
    std::ofstream(folder / "tiles/letters.txt") << "mine";
    try {
        writeTiles(folder / "tiles", ring(Vec3d(0)).levels, GetParam());
        FAIL();
    } catch (const OperationError& error) {
        EXPECT_THAT(error.what(), HasSubstr("move it away"));
    }
    EXPECT_EQ(bytesOf(folder / "tiles/letters.txt"), "mine");
}

// Neuroglancer's volumes, skeletons and meshes of one resolution have an `info`, too.
TEST_P(TileFolder, WithAnythingElseInItIsNotReplaced) {
    const TempFolder folder;
    const Ladder3 ladder = ring(Vec3d(0));
    const auto refusal = [&] {
        try {
            writeTiles(folder / "tiles", ladder.levels, GetParam());
        } catch (const OperationError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    fs::create_directory(folder / "tiles");
    std::ofstream(folder / "tiles/info") << R"({"@type": "neuroglancer_skeletons"})";
    std::ofstream(folder / "tiles/1") << "mine";
    EXPECT_THAT(refusal(), HasSubstr("move it away"));
    EXPECT_EQ(bytesOf(folder / "tiles/1"), "mine");
    fs::remove_all(folder / "tiles");
    EXPECT_EQ(refusal(), "");
    std::ofstream(folder / "tiles/letters.txt") << "mine";
    EXPECT_THAT(refusal(), HasSubstr("move it away"));
    EXPECT_EQ(bytesOf(folder / "tiles/letters.txt"), "mine");
    fs::remove(folder / "tiles/letters.txt");
    EXPECT_EQ(refusal(), "");
}

TEST_P(TileFolder, IsNotMadeWithoutTrianglesOrWhenStopped) {
    const TempFolder folder;
    EXPECT_THROW(writeTiles(folder / "tiles", std::vector<TileLevel>(2), GetParam()), InputError);
    Progress stopped;
    stopped.stopRequested = [] { return true; };
    EXPECT_THROW(writeTiles(folder / "tiles", ring(Vec3d(0)).levels, GetParam(), {}, stopped), Cancelled);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST_P(TileFolder, IsNotMadeOfVoxelsThatAreNoLengthOrBeyondCounting) {
    const TempFolder folder;
    for (const double voxel : {0.0, -1.0, std::nan(""), HUGE_VAL, 1e-12}) {
        Ladder3 ladder = ring(Vec3d(0));
        ladder.levels.front().voxel = voxel;
        EXPECT_THROW(writeTiles(folder / "tiles", ladder.levels, GetParam()), InputError) << voxel;
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

INSTANTIATE_TEST_SUITE_P(Both, TileFolder, ::testing::Values(TileFormat::neuroglancer, TileFormat::tiles3d),
                         [](const auto& with) {
                             return with.param == TileFormat::neuroglancer ? "neuroglancer" : "tiles3d";
                         });

// ---- cutting

double areaOf(const ClippedMesh& mesh) {
    double area = 0;
    for (const Triangle& t : mesh.triangles) {
        Vec3 u, v;
        for (int a = 0; a < 3; ++a) {
            const auto k = static_cast<std::size_t>(a);
            u[a] = static_cast<double>(mesh.points[t[1]][k] - mesh.points[t[0]][k]);
            v[a] = static_cast<double>(mesh.points[t[2]][k] - mesh.points[t[0]][k]);
        }
        area += length(cross(u, v)) / 2;
    }
    return area;
}

TEST(ClipToPlanes, ATriangleBecomesThePiecesOfItsCells) {
    // Legs of 300 along x and y, tiles of 100: 3 whole squares below the hypotenuse and 3 halves.
    const ClippedMesh mesh =
        clipToPlanes({{0, 0, 5}, {300, 0, 5}, {0, 300, 5}}, {}, {{0, 1, 2}}, {100, false});
    EXPECT_EQ(mesh.triangles.size(), 3 * 2 + 3u);
    EXPECT_EQ(areaOf(mesh), 45000);
    EXPECT_EQ(tilesOf(mesh, {100, false}).size(), 6u);
    EXPECT_EQ(mesh.points.size(), 10u);  // of a grid of 4 x 4 those up to the diagonal
}

TEST(ClipToPlanes, WhatLiesWithinOrTouchesIsNotCut) {
    const ClippedMesh mesh = clipToPlanes({{0, 0, 0}, {100, 0, 0}, {0, 100, 50}, {0, 100, 100}}, {},
                                          {{0, 1, 2}, {0, 2, 3}}, {100, false});
    EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
    EXPECT_EQ(mesh.points.size(), 4u);
}

TEST(ClipToPlanes, ATriangleInAPlaneBelongsAboveIt) {
    const ClippedMesh mesh =
        clipToPlanes({{10, 10, 100}, {20, 10, 100}, {10, 20, 100}}, {}, {{0, 1, 2}}, {100, false});
    const auto tiles = tilesOf(mesh, {100, false});
    ASSERT_EQ(tiles.size(), 1u);
    EXPECT_EQ(tiles[0].tile, (TileIndex{0, 0, 1}));
}

// Above y = 100 this triangle has a chord that rounding has laid into z = 100, and lies on both sides of that plane.
TEST(ClipToPlanes, AnEdgeThatRoundingLaysIntoAPlaneIsOfOneSide) {
    const ClippedMesh mesh =
        clipToPlanes({{50, 90, 100}, {0, 200, 99}, {100, 200, 103}}, {}, {{0, 1, 2}}, {100, false});
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(edges.emplace(t[k], t[(k + 1) % 3]).second);
    std::size_t open = 0;
    for (const auto& [a, b] : edges) open += !edges.count({b, a});
    EXPECT_EQ(open, 6u);  // the triangle's three, cut in three places
    EXPECT_EQ(tilesOf(mesh, {100, false}).size(), 3u);
}

TEST(ClipToPlanes, NormalsTurnAlongTheEdge) {
    const ClippedMesh mesh = clipToPlanes({{0, 0, 0}, {200, 0, 0}, {0, 50, 0}},
                                          {{1, 0, 0}, {0, 1, 0}, {1, 0, 0}}, {{0, 1, 2}}, {100, false});
    ASSERT_EQ(mesh.normals.size(), mesh.points.size());
    EXPECT_NEAR(mesh.normals[3][0], std::sqrt(0.5), 1e-6);
    EXPECT_NEAR(mesh.normals[3][1], std::sqrt(0.5), 1e-6);
}

TEST(TilePlanes, OfOddTilesHaveTheirMiddlesWhereNeuroglancerHasThem) {
    const TilePlanes planes{65535, true};
    EXPECT_EQ(planes.at(0), 0);
    EXPECT_EQ(planes.at(1), 32768);
    EXPECT_EQ(planes.at(2), 65535);
    EXPECT_EQ(planes.at(-1), -65535 + 32768);
    for (const std::int64_t x :
         {-65536, -65535, -32768, -32767, -1, 0, 1, 32767, 32768, 65534, 65535, 200000}) {
        const std::int64_t n = planes.lastAtOrBelow(x);
        EXPECT_LE(planes.at(n), x);
        EXPECT_GT(planes.at(n + 1), x);
    }
}

TEST(KeepApart, EqualPointsPartOnTheirPlanes) {
    const TilePlanes planes{100, false};
    std::vector<LatticePoint> points{{50, 50, 50},    {50, 50, 50},    {100, 50, 50},
                                     {100, 50, 50},   {100, 200, 99},  {100, 200, 99},
                                     {100, 100, 100}, {100, 100, 100}, {50, 50, 50}};
    keepApart(points, planes);
    EXPECT_EQ(points[0], (LatticePoint{50, 50, 50}));
    EXPECT_EQ(points[3][0], 100);                        // stays on x = 100
    EXPECT_EQ(points[5], (LatticePoint{100, 200, 98}));  // 100 is a plane: not towards it
    EXPECT_EQ(points[7], points[6]);                     // a corner of the grid has no other place
    EXPECT_EQ(std::set<LatticePoint>(points.begin(), points.end()).size(), points.size() - 1);
}

TEST(ShiftOf, IsAPowerOfTwoThatLeavesTheTreeAsItIs) {
    std::vector<TileMap<int>> levels(2, TileMap<int>(&zOrderLess));
    levels[0][{5, 0, 0}] = 1;
    EXPECT_EQ(shiftOf(levels), 0);
    levels[1][{-1, 0, 3}] = 1;
    EXPECT_EQ(shiftOf(levels), 8);
}

}  // namespace
}  // namespace isowave
