// One GLB of several levels: read back by glTF's own rules (accessor, then the node's scale and translation).
#include "io/mesh/glb_lods.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "io/mesh/distance/distance_colours.h"
#include "io/mesh/read.h"
#include "isowave/error.h"

namespace isowave {
namespace {

namespace fs = std::filesystem;

class GlbLodsFile : public testing::TestWithParam<bool> {
  protected:
    GlbLodsFile()
        : path_(fs::temp_directory_path() / ("isowave_lods_" + std::to_string(::getpid()) + ".glb")) {}
    ~GlbLodsFile() override { fs::remove(path_); }

    // A pyramid of four sides, at a place far from the origin, in millimetres, z up.
    static TriangleMesh tent(double height) {
        TriangleMesh mesh{{{1000, 0, 0}, {1040, 0, 0}, {1040, 30, 0}, {1000, 30, 0}, {1020, 15, height}},
                          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {0, 3, 2}, {0, 2, 1}},
                          {}};
        mesh.normals = {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {-0.6f, 0, 0.8f}, {0, 0, 1}};
        return mesh;
    }
    // distances: of each level's points, or none.
    void write(const std::vector<TriangleMesh>& levels, const std::vector<std::vector<float>>& distances = {},
               double range = 0) {
        GlbLods lods({Space::lps, 0.001}, GetParam());
        double coverage = 0.5;
        for (const TriangleMesh& mesh : levels) {
            const auto i = static_cast<std::size_t>(count_);
            lods.add("L" + std::to_string(count_++), mesh, coverage,
                     distances.empty() ? std::vector<float>() : distances[i]);
            coverage /= 2;
        }
        lods.write(path_, range);
        std::ifstream file(path_, std::ios::binary);
        bytes_.assign(std::istreambuf_iterator<char>(file), {});
        std::uint32_t length = 0;
        std::memcpy(&length, bytes_.data() + 12, 4);
        gltf_ = nlohmann::json::parse(bytes_.substr(20, length));
        binary_ = bytes_.substr(28 + length);
    }
    template <class T>
    T at(std::size_t place) const {
        T value;
        std::memcpy(&value, binary_.data() + place, sizeof value);
        return value;
    }
    // A position of a level, in metres, where a viewer puts it.
    Point position(std::size_t level, std::size_t vertex) const {
        const auto& node = gltf_["nodes"][level];
        const auto& primitive = gltf_["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
        const auto& accessor = gltf_["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
        const auto& view = gltf_["bufferViews"][accessor["bufferView"].get<std::size_t>()];
        const std::size_t place =
            view["byteOffset"].get<std::size_t>() + vertex * view["byteStride"].get<std::size_t>();
        Point p;
        for (std::size_t a = 0; a < 3; ++a) {
            const double stored = accessor["componentType"] == 5126 ? at<float>(place + 4 * a)
                                                                    : at<std::uint16_t>(place + 2 * a);
            EXPECT_GE(stored, accessor["min"][a].get<double>());
            EXPECT_LE(stored, accessor["max"][a].get<double>());
            p[a] = stored * (node.contains("scale") ? node["scale"][a].get<double>() : 1) +
                   node["translation"][a].get<double>();
        }
        return p;
    }

    // Where the values of a level's attribute begin.
    std::size_t startOf(std::size_t level, const char* attribute) const {
        const auto& attributes = gltf_["meshes"][level]["primitives"][0]["attributes"];
        const auto& accessor = gltf_["accessors"][attributes[attribute].get<std::size_t>()];
        EXPECT_EQ(accessor["count"], 5);
        return gltf_["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"]
            .get<std::size_t>();
    }

    fs::path path_;
    std::string bytes_, binary_;
    nlohmann::json gltf_;
    int count_ = 0;
};

TEST_P(GlbLodsFile, EveryLevelLiesWhereItsMeshDoes) {
    const std::vector<TriangleMesh> levels = {tent(20), tent(22), tent(35)};
    write(levels);
    for (std::size_t level = 0; level < levels.size(); ++level)
        for (std::size_t v = 0; v < 5; ++v) {
            const Point& p = levels[level].points[v];
            const Point wanted = {p[0] / 1000, p[2] / 1000, -p[1] / 1000}, found = position(level, v);
            for (std::size_t a = 0; a < 3; ++a)
                EXPECT_NEAR(found[a], wanted[a], 0.5001 * 0.04 / 65535) << level << ' ' << v << ' ' << a;
        }
}

TEST_P(GlbLodsFile, TheSceneHasTheFinestAndTheOthersAreItsLevels) {
    write({tent(20), tent(22), tent(35)});
    EXPECT_EQ(gltf_["scenes"][0]["nodes"], nlohmann::json::array({0}));
    EXPECT_EQ(gltf_["nodes"][0]["extensions"]["MSFT_lod"]["ids"], nlohmann::json::array({1, 2}));
    EXPECT_EQ(gltf_["nodes"][0]["extras"]["MSFT_screencoverage"], nlohmann::json::array({0.5, 0.25, 0.125}));
    EXPECT_EQ(gltf_["nodes"][2]["name"], "L2");
    EXPECT_EQ(gltf_["asset"]["extras"]["SPACE"], "LPS");
    EXPECT_EQ(gltf_.contains("extensionsRequired"), GetParam());
    EXPECT_EQ(gltf_["buffers"][0]["byteLength"], binary_.size());
    std::uint32_t total = 0;
    std::memcpy(&total, bytes_.data() + 8, 4);
    EXPECT_EQ(total, bytes_.size());
}

TEST_P(GlbLodsFile, VerticesAndIndicesAreAlignedToFour) {
    write({tent(20), tent(22)});
    for (const auto& view : gltf_["bufferViews"]) {
        EXPECT_EQ(view["byteOffset"].get<int>() % 4, 0);
        if (!view.contains("byteStride")) continue;
        EXPECT_EQ(view["byteStride"].get<int>() % 4, 0);
    }
}

TEST_P(GlbLodsFile, DistancesOfAllLevelsHaveOneRangeOfColours) {
    const std::vector<std::vector<float>> distances = {
        {0, 0, 0, 0, 0}, {0, 0.25F, 1, 0, 0.5F}, {2, 1, 0.5F, 4, 0}};
    for (const double range : {0.0, 8.0}) {
        count_ = 0;
        write({tent(20), tent(22), tent(35)}, distances, range);
        const double last = range > 0 ? range : 4;  // the largest of all levels
        for (std::size_t level = 0; level < 3; ++level) {
            EXPECT_EQ(gltf_["meshes"][level]["extras"]["distance_of_last_colour"], last);
            const std::size_t at = startOf(level, "_DISTANCE_TO_LEVEL0"), colour = startOf(level, "COLOR_0");
            for (std::size_t v = 0; v < 5; ++v) {
                EXPECT_EQ(this->at<float>(at + 4 * v), distances[level][v]);
                EXPECT_EQ(this->at<StoredColour>(colour + 8 * v),
                          storedDistanceColour(distances[level][v], last));
            }
        }
        EXPECT_EQ(gltf_["buffers"][0]["byteLength"], binary_.size());
        EXPECT_NEAR(position(2, 4)[1], 0.035, 1e-6);  // shapes are where they were
    }
}

TEST_P(GlbLodsFile, WithoutDistancesThereAreNoColours) {
    write({tent(20), tent(22)});
    EXPECT_EQ(bytes_.find("COLOR_0"), std::string::npos);
    EXPECT_EQ(bytes_.find("distance_of_last_colour"), std::string::npos);
}

TEST_P(GlbLodsFile, OneLevelNeedsNoExtensionForLevels) {
    write({tent(20)});
    EXPECT_EQ(bytes_.find("MSFT_lod"), std::string::npos);
}

TEST_P(GlbLodsFile, WithoutLevelsThereIsNoFile) {
    EXPECT_THROW(GlbLods({}, GetParam()).write(path_), InputError);
    EXPECT_FALSE(fs::exists(path_));
}

INSTANTIATE_TEST_SUITE_P(Both, GlbLodsFile, testing::Bool(),
                         [](const auto& with) { return with.param ? "quantized" : "float32"; });

// What does not know MSFT_lod shows the finest level.
TEST(GlbLods, AsFloatsIsReadAsItsFinestLevel) {
    const fs::path path =
        fs::temp_directory_path() / ("isowave_lods_read_" + std::to_string(::getpid()) + ".glb");
    GlbLods lods({Space::unspecified, 0.001}, false);
    const TriangleMesh fine{
        {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, {}};
    TriangleMesh coarse = fine;
    coarse.triangles.pop_back();
    lods.add("L0", fine, 0.5);
    lods.add("L1", coarse, 0.25);
    lods.write(path);
    EXPECT_EQ(readMesh(path).triangles.size(), 4u);
    fs::remove(path);
}

}  // namespace
}  // namespace isowave
