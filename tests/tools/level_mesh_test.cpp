// lod, mesh and info agree on a level, in files and in words; what levels are like is tested in tests/lod.
#include <cmath>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

// A grey image of a signed distance, 20 HU a voxel, of spacing 0.5 mm.
template <class Distance>
void writeDistance(const fs::path& file, Size size, const Distance& distance) {
    writeNrrd(
        file, size,
        sampled<std::int16_t>(size,
                              [&](int x, int y, int z) {
                                  return std::lround(std::clamp(-20.0 * distance(x, y, z), -200.0, 200.0));
                              }),
        "spacings: 0.5 0.5 0.5\n");
}

// A box 40 x 40 x 14 with four holes of radius 1.5, 2.5, 4 and 6 voxels through it, and a grain of radius 1.7 beside it.
double plate(double x, double y, double z) {
    const double radius[] = {1.5, 2.5, 4, 6};
    double d = std::max({std::abs(x - 27.3) - 22.2, std::abs(y - 27.4) - 22.1, std::abs(z - 12.2) - 5.1});
    for (int i = 0; i < 4; ++i)
        d = std::max(d, radius[i] - std::hypot(x - 16.6 - 21.7 * (i % 2), y - 16.1 - 22.3 * (i / 2)));
    return std::min(d, std::hypot(x - 27, y - 27, z - 24.1) - 1.7);
}

// A wall 2 voxels thick, in a frame that is 8 thick.
double framedWall(double x, double y, double z) {
    const double a = std::max(std::abs(x - 30.2), std::abs(y - 29.7)), h = std::abs(z + 0.15 * x - 20.3);
    return std::min(std::max(h - 1, a - 22), std::max({h - 4, a - 22, 16 - a}));
}

class Levels : public ::testing::Test {
  protected:
    Levels() {
        writeDistance(folder / "plate.nrrd", {56, 56, 30}, plate);
        writeDistance(folder / "wall.nrrd", {62, 62, 36}, framedWall);
    }
    Json lod(const std::string& name, const Arguments& more, Result* result = nullptr) {
        Arguments arguments{
            "lod", (folder / (name + ".nrrd")).string(), "--iso", "0", "-o", (folder / "out").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result r = succeed(arguments);
        if (result) *result = r;
        return jsonFile(folder / "out/report.json")["levels"];
    }
    Folder folder;
};

TEST_F(Levels, AreTheSameFromMeshAsFromLod) {
    for (const std::string option : {"--preserve-volume", "--hold=shift", "--hold=none", "--keep-specks"}) {
        lod("wall", {"--levels", "0..2", option});
        succeed({"mesh", (folder / "wall.nrrd").string(), "--iso", "0", "--level", "2", option, "-o",
                 (folder / "one.ply").string()});
        EXPECT_EQ(contentOf(folder / "one.ply"), contentOf(folder / "out/out_L2.ply")) << option;
    }
}

TEST_F(Levels, AreToldInALineEach) {
    Result result;
    const Json levels = lod("plate", {"--levels", "0..3", "--features", "--preserve-volume"}, &result);
    for (const char* words :
         {"level 2 (2 mm): ", "holes closed up to radius", "moves the surface by", "coefficients stored for"})
        EXPECT_NE(result.out.find(words), std::string::npos) << result.out;
    EXPECT_EQ(levels[0]["features"]["handles"]["largest_vanished"], nullptr);
    EXPECT_EQ(lod("plate", {"--levels", "0..1"})[1]["features"], nullptr);
}

TEST_F(Levels, RefuseTwoReasonsForOneIsoValue) {
    const std::string in = (folder / "wall.nrrd").string(), out = (folder / "o").string();
    for (const Arguments& more : {Arguments{"--preserve-volume", "--hold", "shift"},
                                  Arguments{"--preserve-volume", "--open-border"}}) {
        Arguments arguments{"lod", in, "--iso", "0", "-o", out};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, 2);
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_NE(result.err.find("--preserve-volume"), std::string::npos);
        EXPECT_FALSE(fs::exists(out));
    }
}

TEST_F(Levels, AreSampledFinerWhereTheMeshPerforatesThinWalls) {
    const std::string pinion = std::string(ISOWAVE_TEST_DATA) + "/meshes/pinion.off";
    succeed({"lod", pinion, "--voxels", "64", "--levels", "0..3", "--hold", "shift", "-o",
             (folder / "p").string()});
    EXPECT_EQ(jsonFile(folder / "p/report.json")["levels"][3]["refine"], 2);
    succeed({"mesh", pinion, "--voxels", "64", "--level", "3", "--hold", "shift", "-o",
             (folder / "p.ply").string()});
    EXPECT_EQ(contentOf(folder / "p.ply"), contentOf(folder / "p/p_L3.ply"));
}

TEST_F(Levels, OfAPyramidAreToldByInfo) {
    const std::string pyramid = (folder / "plate.pyramid.vdb").string();
    succeed({"analyse", (folder / "plate.nrrd").string(), "--iso", "0", "-o", pyramid});
    const Json levels = lod("plate", {});
    const Json info = succeed({"info", pyramid, "--json", "-"}).json()["levels"];
    ASSERT_GE(info.size(), 3u);
    for (std::size_t i = 0; i < info.size(); ++i)
        for (const char* key :
             {"level", "spacing", "parts", "genus", "cavities", "change", "triangles", "specks_removed"})
            EXPECT_EQ(info[i][key], levels[i][key]) << i << " " << key;
    const std::string text = succeed({"info", pyramid}).out;
    EXPECT_NE(text.find("level 0 (0.5 mm): 4 handles, 2 parts"), std::string::npos) << text;
    EXPECT_NE(text.find("level 1 (1 mm): "), std::string::npos) << text;
    const std::string more = succeed({"info", pyramid, "--features"}).out;
    EXPECT_NE(more.find("open from radius"), std::string::npos) << more;
}

}  // namespace
}  // namespace isowave::tools_test
