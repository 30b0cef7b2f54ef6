// isowave lod --fine: regions that keep a finer level. What such levels are like is tested in tests/lod.
#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Arguments = std::vector<std::string>;
using Json = nlohmann::json;

// A ring about the z axis.
class RingRegions : public ::testing::Test {
  protected:
    RingRegions() { writeStl(folder / "ring.stl", torus(20, 8)); }

    Arguments command(Arguments more) const {
        Arguments arguments{"lod", (folder / "ring.stl").string(), "--voxels", "40", "--levels", "0..2",
                            "-o",  (folder / "out/ring").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    Json levels(Arguments more) const {
        succeed(command(std::move(more)));
        return jsonFile(folder / "out/ring/report.json")["levels"];
    }
    // The one line of a run that fails.
    std::string complaint(int exitCode, Arguments more) const {
        const Result result = isowave(command(std::move(more)));
        EXPECT_EQ(result.exitCode, exitCode) << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_FALSE(fs::exists(folder / "out"));
        return result.err;
    }

    Folder folder;
};

TEST_F(RingRegions, AreToldInTheReportAndTheText) {
    const Json plain = levels({});
    for (const Json& level : plain) EXPECT_TRUE(level["regions"].is_null());
    const std::string text = succeed(command({"--fine", "-40,-40,-40:0,40,40"})).out;
    EXPECT_NE(text.find("in the regions"), std::string::npos) << text;
    const Json kept = jsonFile(folder / "out/ring/report.json")["levels"];
    EXPECT_TRUE(kept[0]["regions"].is_null());
    const Json& r = kept[2]["regions"];
    EXPECT_EQ(r["triangles_inside"].get<int>() + r["triangles_fading"].get<int>() +
                  r["triangles_outside"].get<int>(),
              kept[2]["triangles"].get<int>());
    EXPECT_GT(r["triangles_inside"], plain[2]["triangles"]);
    EXPECT_LT(r["triangles_outside"], plain[2]["triangles"]);
    EXPECT_GT(r["control_points_fine"], 0);
    EXPECT_LT(r["control_points_coarse"], plain[2]["control_points"]);
    EXPECT_LT(r["rms_to_level0_inside"], r["rms_to_level0_outside"]);
    EXPECT_LE(r["max_to_level0_outside"], plain[2]["max_to_level0"].get<double>() * 1.5);
    EXPECT_EQ(kept[2]["closed"], true);
    EXPECT_EQ(kept[2]["manifold"], true);
}

TEST_F(RingRegions, AreBoxesAndMeshesOfAnyLevelAndMayBeWidened) {
    const auto inside = [&](Arguments more) {
        return levels(std::move(more))[2]["regions"]["triangles_inside"].get<int>();
    };
    const int one = inside({"--fine", "20,0,0:30,10,8"});
    EXPECT_EQ(inside({"--fine", "30,10,8:20,0,0"}), one);  // any two opposite corners
    EXPECT_EQ(inside({"--fine", "20,0,0:30,10,8:0"}), one);
    EXPECT_GT(inside({"--fine", "20,0,0:30,10,8", "--fine-within", "3"}), one);
    EXPECT_LT(inside({"--fine", "20,0,0:30,10,8:1"}), one);
    EXPECT_GT(inside({"--fine", "20,0,0:30,10,8", "--fine", "-30,-10,0:-20,0,8"}), one);
    writeStl(folder / "a:b.stl", torus(20, 12));
    const Json whole = levels({"--fine", (folder / "a:b.stl").string() + ":1"});
    EXPECT_EQ(whole[2]["regions"]["triangles_outside"], 0);
    EXPECT_EQ(whole[2]["triangles"], whole[1]["triangles"]);
}

TEST_F(RingRegions, AreRefusedInOneLineWhereTheyAreNone) {
    const auto says = [&](int exitCode, Arguments more, const std::string& expected) {
        const std::string line = complaint(exitCode, std::move(more));
        EXPECT_NE(line.find(expected), std::string::npos) << line;
    };
    says(2, {"--fine", "1,2,3"}, "--fine: '1,2,3' is one corner");
    says(2, {"--fine", "1,2,3:4,5"}, "--fine: '4,5' is not a corner X,Y,Z of a box");
    says(2, {"--fine", "1,2,nan:4,5,6"}, "--fine: 'nan' is not a finite number");
    says(2, {"--fine", "1,2,3:4,5,6:x"}, "--fine: 'x' is not a whole number");
    says(2, {"--fine", "1,2,3:4,5,6:-1"}, "--fine: '-1' is not between 0");
    says(2, {"--fine", "1,2,3:1,5,6"}, "the box is empty");
    says(2, {"--fine", "1,2,3:4,5,6:2"}, "no level is coarser than 2, --levels ends at 2");
    says(2, {"--fine-within", "2"}, "--fine-within: widens the regions of --fine; give one");
    says(2, {"--fine", "1,2,3:4,5,6", "--fine-within", "-2"}, "--fine-within: '-2' is below 0");
    says(2, {"--fine", "1,2,3:4,5,6", "--triangles", "500"}, "--fine and budgets exclude each other");
    says(2, {"--fine", "1,2,3:4,5,6", "--preserve-volume"},
         "--fine and --preserve-volume exclude each other");
    says(3, {"--fine", "100,0,0:101,1,1", "--quiet"},
         "the region is outside the solid, which lies between -27.9");
    says(3, {"--fine", (folder / "none.stl").string(), "--quiet"}, "none.stl");
    SmallMesh open = torus(20, 8);
    open.triangles.resize(open.triangles.size() / 2);
    writeStl(folder / "open.stl", open);
    says(3, {"--fine", (folder / "open.stl").string(), "--quiet"}, "open.stl: is open");
    fs::create_directories(folder / "other");
    says(2, {"--fine", (folder / "ring.stl").string(), "--json", (folder / "ring.stl").string()}, "ring.stl");
}

TEST_F(RingRegions, OfAMeshAreNotReplacedByAResult) {
    fs::create_directories(folder / "out/ring");
    writeStl(folder / "out/ring/ring_L1.stl", torus(20, 12));
    const std::string before = contentOf(folder / "out/ring/ring_L1.stl");
    const Result result =
        isowave(command({"--format", "stl", "--fine", (folder / "out/ring/ring_L1.stl").string()}));
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_NE(result.err.find("is what this command reads"), std::string::npos) << result.err;
    EXPECT_EQ(contentOf(folder / "out/ring/ring_L1.stl"), before);
}

}  // namespace
}  // namespace isowave::tools_test
