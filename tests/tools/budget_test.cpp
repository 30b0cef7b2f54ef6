// isowave lod by budget: triangles, ratios, tolerances, limits on the topology; relaxed and measured meshes.
#include <set>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Arguments = std::vector<std::string>;
using Json = nlohmann::json;

// A ring, which loses its hole at a coarse level.
class RingBudget : public ::testing::Test {
  protected:
    RingBudget() { writeStl(folder / "ring.stl", torus(20, 8)); }

    Arguments command(Arguments more) const {
        Arguments arguments{"lod", (folder / "ring.stl").string(), "--voxels", "40",
                            "-o",  (folder / "out/ring").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    Json report() const { return jsonFile(folder / "out/ring/report.json"); }

    Folder folder;
};

TEST_F(RingBudget, WritesOneMeshABudgetAndSaysWhereItCameFromAndWhy) {
    const std::string text = succeed(command({"--triangles", "400,120", "--ratio", "0.1"})).out;
    const Json r = report();
    EXPECT_TRUE(r["levels"].empty());
    ASSERT_EQ(r["budgets"].size(), 3u);
    const char* names[] = {"ring_T400.ply", "ring_T120.ply", "ring_R0.1.ply"};
    for (int i = 0; i < 3; ++i) {
        const Json& b = r["budgets"][i];
        EXPECT_EQ(b["file"], names[i]);
        EXPECT_TRUE(fs::exists(folder / "out/ring" / names[i]));
        EXPECT_LE(b["triangles"].get<int>(), b["triangles_asked"].get<int>());
        EXPECT_EQ(b["closed"], true);
        EXPECT_EQ(b["manifold"], true);
        EXPECT_EQ(b["genus"], 1);
        EXPECT_NE(b["why"].get<std::string>().find("smallest distance to level 0"), std::string::npos);
        EXPECT_NE(text.find(b["why"].get<std::string>()), std::string::npos);
        for (const char* side : {"to_level0", "from_level0"}) {
            const auto value = [&](const std::string& key) { return b[key + "_" + side].get<double>(); };
            EXPECT_LE(value("rms"), value("max"));
            EXPECT_LE(value("max"), value("max_bound"));
        }
        succeed({"check", (folder / "out/ring" / names[i]).string()});
    }
    EXPECT_FALSE(fs::exists(folder / "out/ring/ring_L0.ply"));
    const std::set<std::string> keys{"file",
                                     "triangles_asked",
                                     "ratio_asked",
                                     "tolerance_asked",
                                     "max_genus",
                                     "min_component",
                                     "step",
                                     "level",
                                     "why",
                                     "vertices",
                                     "triangles",
                                     "components",
                                     "genus",
                                     "closed",
                                     "manifold",
                                     "volume",
                                     "area",
                                     "self_intersections",
                                     "rms_to_level0",
                                     "max_to_level0",
                                     "max_bound_to_level0",
                                     "rms_from_level0",
                                     "max_from_level0",
                                     "max_bound_from_level0",
                                     "max_to_input",
                                     "seconds"};
    std::set<std::string> found;
    for (const auto& item : r["budgets"][0].items()) found.insert(item.key());
    EXPECT_EQ(found, keys);
}

TEST_F(RingBudget, StaysWithinAToleranceAndWritesLevelsTooWhenAsked) {
    succeed(command({"--tolerance", "0.6", "--levels", "0..1", "--format", "stl"}));
    const Json r = report();
    EXPECT_EQ(r["levels"].size(), 2u);
    EXPECT_TRUE(fs::exists(folder / "out/ring/ring_L1.stl"));
    const Json& b = r["budgets"][0];
    EXPECT_EQ(b["file"], "ring_D0.6.stl");
    EXPECT_LE(b["max_to_input"].get<double>(), 0.6);
    EXPECT_LT(b["triangles"].get<double>(), 0.5 * r["levels"][0]["triangles"].get<double>());
    succeed({"check", (folder / "out/ring/ring_D0.6.stl").string()});
}

TEST_F(RingBudget, CutsTheRingWhereNoHandleIsAllowed) {
    succeed(command({"--levels", "0..2", "--max-genus", "0"}));
    EXPECT_EQ(report()["budgets"].size(), 0u) << "a limit by itself is no budget";
    for (const Json& each : report()["levels"]) EXPECT_EQ(each["genus"], 0);
    succeed(command({"--levels", "0", "--max-genus", "0", "--max-parts", "1"}));
    const Json level = report()["levels"][0];
    EXPECT_EQ(level["genus"], 0);
    EXPECT_EQ(level["cuts"]["count"].get<int>() + level["fills"]["count"].get<int>(), 1);
    EXPECT_EQ(level["limits_missed"], nullptr);
}

TEST_F(RingBudget, MeasuresTheDeviationFromTheZeroSetWhenAsked) {
    succeed(command({"--levels", "0..1", "--deviation"}));
    const Json coarse = report()["levels"];
    succeed(command({"--levels", "0..1", "--deviation", "--refine", "2"}));
    const Json fine = report()["levels"];
    for (int l = 0; l < 2; ++l) {
        EXPECT_GT(coarse[l]["max_deviation"].get<double>(), coarse[l]["rms_deviation"].get<double>());
        EXPECT_LT(fine[l]["rms_deviation"].get<double>(), 0.35 * coarse[l]["rms_deviation"].get<double>());
    }
    succeed(command({"--levels", "0"}));
    EXPECT_EQ(report()["levels"][0]["max_deviation"], nullptr);
    const std::string text = succeed({"mesh", (folder / "ring.stl").string(), "--voxels", "40", "-o",
                                      (folder / "ring.ply").string(), "--deviation", "--relax", "3"})
                                 .out;
    EXPECT_NE(text.find("from the zero set"), std::string::npos) << text;
}

TEST_F(RingBudget, RefusesWhatCannotBeInOneLine) {
    for (const auto& [more, code, part] : std::vector<std::tuple<Arguments, int, std::string>>{
             {{"--triangles", "0"}, 2, "is not 4 or more"},
             {{"--triangles", "100,,5"}, 2, "whole number"},
             {{"--ratio", "1.5"}, 2, "above 1"},
             {{"--tolerance", "-1"}, 2, "above 0"},
             {{"--compact", "--threads", "1"}, 2, "--refine 2 or 4"},
             {{"--compact", "--refine", "2", "--relax", "1"}, 2, "exclude each other"},
             {{"--min-component", "1e9"}, 3, "no step has components"},
             {{"--max-parts", "0"}, 2, "is not 1 or more"}}) {
        const Result result = isowave(command(more));
        EXPECT_EQ(result.exitCode, code) << more[1];
        EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_FALSE(fs::exists(folder / "out"));
    }
}

}  // namespace
}  // namespace isowave::tools_test
