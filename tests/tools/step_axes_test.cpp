// --axes: what levels of voxels that are no cubes halve, as commands tell and store it.
#include <gmock/gmock.h>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class FlatVoxels : public ::testing::Test {
  protected:
    // A ball of 10 mm; voxels are 0.5 x 0.5 x 2 mm.
    FlatVoxels() {
        const Size size{50, 50, 14};
        const auto grey = sampled<std::int16_t>(size, [](int x, int y, int z) {
            const double d = std::hypot(0.5 * x - 12.3, 0.5 * y - 12.1, 2.0 * z - 13.2) - 10;
            return std::lround(std::clamp(-40 * d, -100.0, 100.0));
        });
        writeNrrd(folder / "ball.nrrd", size, grey, "spacings: 0.5 0.5 2\n");
    }
    std::string ball() const { return (folder / "ball.nrrd").string(); }
    std::string at(const char* name) const { return (folder / name).string(); }
    Folder folder;
};

std::vector<int> stepsOf(const Json& levels) {
    std::vector<int> steps;
    for (const Json& level : levels) steps.push_back(level["step"]);
    return steps;
}

TEST_F(FlatVoxels, HaveLevelsThatMakeThemCubesFirst) {
    const Result result = succeed({"lod", ball(), "--iso", "0", "--levels", "0..3", "-o", at("out")});
    EXPECT_THAT(result.err, HasSubstr("voxels are 0.5 x 0.5 x 2: the first 2 levels halve x and y only"));
    const Json report = jsonFile(folder / "out/report.json");
    EXPECT_EQ(report["first_levels"], Json({"xy", "xy"}));
    EXPECT_THAT(stepsOf(report["levels"]), ElementsAre(0, 2, 4, 7));
    for (int level = 0; level < 4; ++level) {
        EXPECT_EQ(report["levels"][level]["level"], level);
        EXPECT_EQ(report["levels"][level]["file"], "out_L" + std::to_string(level) + ".ply");
    }
    EXPECT_EQ(report["levels"][2]["spacing"], Json({2, 2, 2}));
    const Result inTurn =
        succeed({"lod", ball(), "--iso", "0", "--axes", "xyz", "--levels", "1", "-o", at("in_turn")});
    EXPECT_THAT(inTurn.err, Not(HasSubstr("halve")));
    const Json other = jsonFile(folder / "in_turn/report.json");
    EXPECT_EQ(other["first_levels"], Json::array());
    EXPECT_EQ(other["levels"][0]["spacing"], Json({1, 1, 4}));
}

TEST_F(FlatVoxels, HaveStepsByTheirNumbers) {
    succeed({"lod", ball(), "--iso", "0", "--steps", "2..5", "-o", at("out")});
    const Json levels = jsonFile(folder / "out/report.json")["levels"];
    EXPECT_THAT(stepsOf(levels), ElementsAre(2, 3, 4, 5));
    EXPECT_EQ(levels[0]["level"], 1);
    EXPECT_TRUE(levels[1]["level"].is_null());
    EXPECT_EQ(levels[1]["file"], "out_s3.ply");
    EXPECT_EQ(levels[2]["level"], 2);
}

TEST_F(FlatVoxels, GiveTheSameLevelsFromAPyramidAndAPackedSolid) {
    succeed({"analyse", ball(), "--iso", "0", "-o", at("ball.vdb")});
    succeed({"pack", ball(), "--iso", "0", "-o", at("ball.iwz")});
    succeed({"mesh", ball(), "--iso", "0", "--level", "2", "-o", at("direct.off")});
    succeed({"mesh", at("ball.iwz"), "--level", "2", "-o", at("packed.off")});
    EXPECT_EQ(contentOf(folder / "packed.off"), contentOf(folder / "direct.off"));
    const Result plain =
        succeed({"mesh", at("ball.vdb"), "--level", "2", "--hold", "none", "-o", at("a.off")});
    EXPECT_THAT(plain.out, HasSubstr("step 4, "));
    succeed({"mesh", at("ball.vdb"), "--step", "4", "--hold", "none", "-o", at("b.off")});
    EXPECT_EQ(contentOf(folder / "b.off"), contentOf(folder / "a.off"));
    EXPECT_THAT(succeed({"field", at("ball.vdb"), "--level", "1", "-o", at("field.vdb")}).out,
                HasSubstr("step 2, "));
    EXPECT_THAT(succeed({"field", at("ball.vdb"), "--level", "3", "-o", at("field.vdb")}).out,
                HasSubstr("voxel 4 x 4 x 4"));
    for (const char* name : {"ball.vdb", "ball.iwz"}) {
        const Json info = succeed({"info", at(name), "--json", "-"}).json();
        EXPECT_EQ(info["first_levels"], Json({"xy", "xy"}));
        EXPECT_EQ(info["steps"][4]["level"], 2);
        EXPECT_EQ(info["steps"][4]["halved"], "y");
        EXPECT_TRUE(info["steps"][3]["level"].is_null());
        EXPECT_TRUE(info["steps"][0]["halved"].is_null());
        EXPECT_EQ(info["levels"][2]["step"], 4);
        const Result refused = isowave({"lod", at(name), "--axes", "xyz", "-o", at("none")});
        EXPECT_EQ(refused.exitCode, 2);
        EXPECT_THAT(refused.err, HasSubstr("--axes has no meaning for"));
    }
}

TEST_F(FlatVoxels, KeepTheirOrderThroughAnEdit) {
    succeed({"pack", ball(), "--iso", "0", "-o", at("ball.iwz")});
    succeed({"edit", at("ball.iwz"), "--cut", "ball:12,12,22,4", "--level", "1", "-o", at("new.vdb")});
    const Json info = succeed({"info", at("new.vdb"), "--json", "-"}).json();
    EXPECT_EQ(info["first_levels"], Json({"xy", "xy"}));
}

TEST_F(FlatVoxels, AreToldByADryRun) {
    const Result result = succeed({"lod", ball(), "--iso", "0", "--dry-run"});
    EXPECT_THAT(result.err, HasSubstr("the first 2 levels halve x and y only"));
    EXPECT_THAT(result.out, HasSubstr("levels  0 to at most"));
}

}  // namespace
}  // namespace isowave::tools_test
