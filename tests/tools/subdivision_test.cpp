// filters, curve-levels, relief: the program itself on real inputs.
#include <gmock/gmock.h>

#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using testing::HasSubstr;

const fs::path kData = fs::path(ISOWAVE_TEST_DATA);

// The options reach the library, whose tests say what it makes of them.
TEST(Filters, AreChosenByNameOrMaskAndPrintedOrDrawn) {
    const Folder folder;
    const std::string text =
        succeed({"filters", "cubic", "--width", "7", "--svg", (folder / "c.svg").string()}).out;
    EXPECT_THAT(text, HasSubstr("1/196 x  23   -92   63  [208]  63   -92   23"));
    EXPECT_THAT(contentOf(folder / "c.svg"), HasSubstr("</svg>"));
    const auto json =
        succeed({"filters", "--mask", "1/8 1/2 3/4 1/2 1/8", "--width", "7", "--json", "-"}).json();
    EXPECT_EQ(json["A"]["values"][0], "23/196");
    EXPECT_EQ(json["proof"]["holds"], true);
    EXPECT_THAT(
        succeed({"filters", "--mask", "1 1/2 1/2 1/2 1/2 1/2 1/2", "--lattice", "triangular", "--width", "2"})
            .out,
        HasSubstr("triangular lattice, A of width 2"));
    EXPECT_THAT(succeed({"filters", "butterfly-3", "--boundary"}).out, HasSubstr("33 taps"));
}

TEST(Filters, OfOneNameAreOfOneFilter) {
    for (const char* name : {"dlg", "dlg-refined"}) {
        EXPECT_THAT(succeed({"filters", name}).out, testing::StartsWith("dlg-refined on the line"));
        EXPECT_THAT(succeed({"filters", name, "--boundary"}).out, testing::StartsWith("dlg-refined, open"));
    }
}

// Before anything is read: wrong usage, not bad data.
TEST(Subdivision, WrongNamesAndCreasesOfLoopAreWrongUsage) {
    const Folder folder;
    const std::string bones = (kData / "meshes" / "bones.off").string(), out = (folder / "x.obj").string();
    const auto coast = (kData / "coast" / "great_britain.txt").string();
    for (const auto& arguments : std::vector<std::vector<std::string>>{
             {"subdivide", bones, "-o", out, "--scheme", "loop", "--crease", "30"},
             {"reverse", bones, "-o", out, "--scheme", "butterfly", "--crease", "30"},
             {"subdivide", bones, "-o", out, "--scheme", "nope"},
             {"reverse", bones, "-o", out, "--variant", "nope"},
             {"curve-levels", coast, "-o", out, "--scheme", "nope"},
             {"relief", (kData / "terrain" / "jacksboro.npy").string(), "-o", out, "--scheme", "nope"}}) {
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, 2) << arguments.back();
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_FALSE(fs::exists(folder / "x.obj"));
    }
}

TEST(CurveLevels, SaysWhatTopoJsonIs) {
    const Folder folder;
    std::ofstream(folder / "t.json") << R"({"type":"Topology","arcs":[],"objects":{}})";
    const Result result =
        isowave({"curve-levels", (folder / "t.json").string(), "-o", (folder / "x").string()});
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_THAT(result.err, HasSubstr("is TopoJSON"));
    EXPECT_THAT(result.err, HasSubstr("topo2geo"));
}

TEST(Json, OfCurvesAndLodMayGoIntoNewFoldersAndTheOutputs) {
    const Folder folder;
    const std::string keys = (kData / "curves2d" / "keyring.png").string();
    succeed({"curves", keys, "-o", (folder / "a").string(), "--levels", "0", "--json",
             (folder / "new/dir/r.json").string()});
    EXPECT_TRUE(fs::exists(folder / "new/dir/r.json"));
    succeed({"curves", keys, "-o", (folder / "b").string(), "--levels", "0", "--json",
             (folder / "b/r.json").string()});
    EXPECT_TRUE(fs::exists(folder / "b/r.json"));
    EXPECT_TRUE(fs::exists(folder / "b/b_L0.svg"));
    const std::string both =
        succeed({"curves", keys, "-o", (folder / "c").string(), "--table", "--json", "-"}).out;
    EXPECT_NO_THROW(nlohmann::json::parse(both));
    const std::string gear = (kData / "meshes" / "gearwheel.bin.stl").string();
    succeed({"lod", gear, "--voxels", "24", "--levels", "0", "-o", (folder / "ee").string(), "--json",
             (folder / "ee/r.json").string()});
    EXPECT_TRUE(fs::exists(folder / "ee/r.json"));
    EXPECT_TRUE(fs::exists(folder / "ee/report.json"));
    succeed({"lod", gear, "--voxels", "24", "--levels", "0", "-o", (folder / "ff").string(), "--json",
             (folder / "gg/hh/r.json").string()});
    EXPECT_TRUE(fs::exists(folder / "gg/hh/r.json"));
}

TEST(CurveLevels, OfACoastAreWrittenAndComeBack) {
    const Folder folder;
    const auto coast = (kData / "coast" / "great_britain.txt").string();
    const auto json = nlohmann::json::parse(succeed({"curve-levels", coast, "-o", (folder / "gb").string(),
                                                     "--compare-schemes", "--json", "-", "--keep", "500"})
                                                .out);
    EXPECT_EQ(json["curves"][0]["details_left"], 500);
    for (const char* name : {"level_0.txt", "level_6.txt", "smooth.txt", "thresholded.txt"})
        EXPECT_TRUE(fs::exists(folder / "gb" / name)) << name;
    EXPECT_THAT(succeed({"curve-levels", coast, "-o", (folder / "gb").string(), "--compare-schemes"}).out,
                HasSubstr("published: Coast"));
}

TEST(Relief, OfATerrainIsWritten) {
    const Folder folder;
    const auto json =
        nlohmann::json::parse(succeed({"relief", (kData / "terrain" / "jacksboro.npy").string(), "-o",
                                       (folder / "r").string(), "--layout", "quincunx", "--json", "-"})
                                  .out);
    EXPECT_EQ(json["levels"][0]["patch"], "hexagon 48");
    EXPECT_LT(json["round_trip"], 1e-9);
    for (const char* name :
         {"level_2.npy", "shade_0.png", "details_1.png", "suppressed.png", "reconstructed.npy"})
        EXPECT_TRUE(fs::exists(folder / "r" / name)) << name;
}

TEST(SubdivisionCommands, WriteLimitPositions) {
    const Folder folder;
    const auto terrain = (kData / "terrain" / "jacksboro.npy").string(),
               coast = (kData / "coast" / "iceland.txt").string();
    const auto written = [&](std::vector<std::string> arguments, const char* name) {
        arguments.insert(arguments.end(), {"--depth", "1", "--json", "-", "-o", (folder / name).string()});
        return succeed(arguments).json()["positions"];
    };
    EXPECT_EQ(written({"relief", terrain, "--scheme", "loop-1"}, "control"), "control");
    EXPECT_EQ(written({"relief", terrain, "--scheme", "loop-1", "--limit"}, "limit"), "limit");
    EXPECT_EQ(written({"curve-levels", coast, "--scheme", "cubic-7"}, "control"), "control");
    EXPECT_EQ(written({"curve-levels", coast, "--scheme", "cubic-7", "--limit"}, "limit"), "limit");
    const auto same = [&](const char* name) {
        return contentOf(folder / "control" / name) == contentOf(folder / "limit" / name);
    };
    for (const char* name : {"level_0.npy", "level_1.npy", "suppressed.npy", "level_0.txt", "level_1.txt"})
        EXPECT_FALSE(same(name)) << name;
    EXPECT_TRUE(same("reconstructed.npy"));
}

// The written levels are the library's, whose tests say what rebuild() makes of them.
TEST(LevelDetails, BringCurvesOfEveryFormatBack) {
    for (const fs::path& input : {kData / "coast" / "iceland.txt", kData / "curves2d" / "africa.geojson"}) {
        const Folder folder;
        const std::string extension = input.extension().string(), details = (folder / "new/d").string();
        succeed({"curve-levels", input.string(), "-o", (folder / "levels").string(), "--depth", "3",
                 "--details", details, "--quiet"});
        const auto level = [&](int k) {
            return (folder / "levels" / ("level_" + std::to_string(k) + extension)).string();
        };
        const auto rebuild = [&](const std::string& name, std::vector<std::string> more) {
            std::vector<std::string> arguments{"rebuild", level(3), "--details",
                                               details,   "-o",     (folder / (name + extension)).string(),
                                               "--json",  "-"};
            arguments.insert(arguments.end(), more.begin(), more.end());
            return succeed(arguments).json();
        };
        const auto report = rebuild("back", {});
        EXPECT_EQ(contentOf(folder / ("back" + extension)), contentOf(level(0)));
        EXPECT_EQ(report["details"], report["kept"]);
        EXPECT_EQ(report["error"]["largest"], 0);
        rebuild("middle", {"--depth", "2"});
        EXPECT_EQ(contentOf(folder / ("middle" + extension)), contentOf(level(1)));
        EXPECT_EQ(rebuild("part", {"--threshold", "1e9"})["kept"], 0);
        const auto edited = rebuild("edited", {"--edited", level(3), "--frames", "local"});
        EXPECT_EQ(edited["points"], report["points"]);
        EXPECT_EQ(rebuild("limit", {"--limit"})["positions"], "limit");
    }
}

TEST(LevelDetails, OfCurvesHoldWhatKeepLeaves) {
    const Folder folder;
    const auto coast = (kData / "coast" / "great_britain.txt").string();
    const auto write = [&](const char* name, std::vector<std::string> more) {
        std::vector<std::string> arguments{
            "curve-levels",           coast,    "-o", (folder / "l").string(), "--details",
            (folder / name).string(), "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        succeed(arguments);
    };
    write("whole", {});
    write("part", {"--keep", "500"});
    EXPECT_LT(3 * fs::file_size(folder / "part"), fs::file_size(folder / "whole"));
    const auto report =
        succeed({"rebuild", (folder / "l/level_6.txt").string(), "--details", (folder / "part").string(),
                 "-o", (folder / "back.txt").string(), "--json", "-"})
            .json();
    EXPECT_EQ(report["kept"], 500);
    EXPECT_EQ(contentOf(folder / "back.txt"), contentOf(folder / "l/thresholded.txt"));
}

TEST(LevelDetails, BringHeightsBack) {
    const Folder folder;
    const auto details = (folder / "d").string(), terrain = (kData / "terrain" / "jacksboro.npy").string();
    succeed({"relief", terrain, "-o", (folder / "r").string(), "--details", details, "--quiet"});
    const auto rebuild = [&](std::vector<std::string> more) {
        std::vector<std::string> arguments{
            "rebuild", (folder / "r/level_2.npy").string(), "--details", details,
            "-o",      (folder / "x.npy").string(),         "--json",    "-"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return succeed(arguments).json();
    };
    rebuild({});
    EXPECT_EQ(contentOf(folder / "x.npy"), contentOf(folder / "r/reconstructed.npy"));
    rebuild({"--depth", "1"});
    EXPECT_EQ(contentOf(folder / "x.npy"), contentOf(folder / "r/level_1.npy"));
    rebuild({"--edited", (folder / "r/level_2.npy").string()});
    EXPECT_EQ(contentOf(folder / "x.npy"), contentOf(folder / "r/reconstructed.npy"));
    EXPECT_EQ(rebuild({"--keep", "900"})["kept"], 900);
}

TEST(LevelDetails, ThatDoNotBelongAreRefusedInOneLine) {
    const Folder folder;
    const auto at = [&](const std::string& name) { return (folder / name).string(); };
    succeed({"curve-levels", (kData / "coast" / "iceland.txt").string(), "-o", at("c"), "--depth", "2",
             "--details", at("c.d"), "--scheme", "cubic-7", "--quiet"});
    succeed({"curve-levels", (kData / "coast" / "iceland.txt").string(), "-o", at("limit"), "--depth", "2",
             "--limit", "--scheme", "cubic-7", "--quiet"});
    succeed({"relief", (kData / "terrain" / "jacksboro.npy").string(), "-o", at("r"), "--details", at("r.d"),
             "--quiet"});
    std::ofstream(folder / "cut", std::ios::binary) << contentOf(folder / "c.d").substr(0, 100);
    std::ofstream(folder / "other.txt") << "0 0\n1 1\n2 0\n";
    const auto before = folder.snapshot();
    const struct {
        std::string base, details;
        std::vector<std::string> more;
        int code;
        const char* says;
    } cases[] = {
        {at("c/level_1.txt"), at("c.d"), {}, 3, "the coarse curve of the details is"},
        {at("limit/level_2.txt"), at("c.d"), {}, 3, "what was written without --limit"},
        {at("c/level_2.txt"), at("c.d"), {"--edited", at("other.txt")}, 3, "other.txt: curve 0 is"},
        {at("c/level_2.txt"), at("c.d"), {"--depth", "3"}, 3, "holds details for 2 levels"},
        {at("c/level_2.txt"), at("c.d"), {"--keep", "-2"}, 2, "--keep"},
        {at("c/level_2.txt"), at("c.d"), {"--threshold", "nan"}, 2, "--threshold"},
        {at("c/level_2.txt"), at("c.d"), {"--threshold", "-1"}, 2, "--threshold"},
        {at("c/level_2.txt"), at("c.d"), {"--error-table"}, 2, "--error-table: is of meshes"},
        {at("c/level_2.txt"), at("c.d"), {"-o", at("x.svg")}, 2, "name it .txt"},
        {at("c/level_2.txt"), at("cut"), {}, 3, "it is truncated"},
        {at("c/level_2.txt"), at("none"), {"-o", at("x.obj")}, 3, "none: "},
        {at("c/level_2.txt"), at("other.txt"), {"-o", at("x.obj")}, 3, "holds no details of a mesh"},
        {at("r/level_1.npy"), at("r.d"), {"-o", at("x.npy")}, 3, "the coarse heights of the details have"},
        {at("r/level_2.npy"),
         at("r.d"),
         {"-o", at("x.npy"), "--edited", at("r/level_0.npy")},
         3,
         "level_0.npy: has 161"},
        {at("r/level_2.npy"),
         at("r.d"),
         {"-o", at("x.npy"), "--edited", at("r/level_2.npy"), "--frames", "local"},
         2,
         "has no meaning for heights"},
        {at("r/level_2.npy"), at("r.d"), {}, 2, "name it .npy"},
        {at("r/level_2.npy"), at("c.d"), {"-o", at("x.npy")}, 3, "level_2.npy"},
    };
    for (const auto& bad : cases) {
        std::vector<std::string> arguments{"rebuild", bad.base, "--details", bad.details};
        arguments.insert(arguments.end(), bad.more.begin(), bad.more.end());
        if (std::find(bad.more.begin(), bad.more.end(), "-o") == bad.more.end())
            arguments.insert(arguments.end(), {"-o", at("x.txt")});
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, bad.code) << bad.says << ": " << result.err;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_THAT(result.err, HasSubstr(bad.says));
        EXPECT_EQ(folder.snapshot(), before) << bad.says;
    }
}

TEST(RebuildOfQuincunx, GivesWhatReliefHasReconstructedToTheByte) {
    const Folder folder;
    const auto at = [&](const std::string& name) { return (folder / name).string(); };
    succeed({"relief", (kData / "terrain" / "jacksboro.npy").string(), "-o", at("q"), "--layout", "quincunx",
             "--details", at("q.d")});
    succeed({"rebuild", at("q/level_2.npy"), "--details", at("q.d"), "-o", at("again.npy")});
    EXPECT_EQ(contentOf(folder / "again.npy"), contentOf(folder / "q/reconstructed.npy"));
    succeed({"rebuild", at("q/level_2.npy"), "--details", at("q.d"), "--edited", at("q/level_2.npy"),
             "--depth", "1", "-o", at("level_1.npy")});
    EXPECT_EQ(contentOf(folder / "level_1.npy"), contentOf(folder / "q/level_1.npy"));
    // Of every second sample, a picture without gaps is no base.
    const Result other = isowave({"rebuild", (kData / "terrain" / "jacksboro.npy").string(), "--details",
                                  at("q.d"), "-o", at("no.npy")});
    EXPECT_EQ(other.exitCode, 3);
    EXPECT_EQ(other.errorLines(), 1) << other.err;
    EXPECT_FALSE(fs::exists(folder / "no.npy"));
}

// Two triangles with points of their own: the edge between them is twice on the border, and subdivision opens it.
TEST(SubdivisionCommands, SayWhereBordersLieOnEachOther) {
    const Folder folder;
    const auto at = [&](const std::string& name) { return (folder / name).string(); };
    std::ofstream(at("two.off"))
        << "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 3 4 5\n";
    const Result seam = isowave({"subdivide", at("two.off"), "--scheme", "loop", "-o", at("fine.off")});
    EXPECT_EQ(seam.exitCode, 0);
    EXPECT_THAT(
        seam.err,
        HasSubstr("two.off: 2 edges of the border lie on each other: the surface opens there; merge "));
    std::ofstream(at("one.off")) << "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n3 1 3 2\n";
    EXPECT_EQ(isowave({"subdivide", at("one.off"), "--scheme", "loop", "-o", at("fine.off")}).err, "");
}

TEST(SubdivisionCommands, RefuseBadInputInOneLine) {
    const Folder folder;
    const auto out = (folder / "out").string(), terrain = (kData / "terrain" / "jacksboro.npy").string(),
               coast = (kData / "coast" / "iceland.txt").string();
    std::ofstream(folder / "short.txt") << "0 0\n1 0\n1 1\n";
    std::ofstream(folder / "nan.txt") << "0 0\n1 nan\n1 1\n";
    std::ofstream(folder / "cube.off")
        << "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
           "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    const struct {
        std::vector<std::string> arguments;
        int code;
        const char* says;
    } cases[] = {
        {{"filters"}, 2, "name a subdivision"},
        {{"filters", "cubic", "--mask", "1 1"}, 2, "not both"},
        {{"filters", "cubic", "--lattice", "quad"}, 2, "--lattice: says where a --mask lives"},
        {{"filters", "nurbs"}, 2, "chaikin, cubic, dlg"},
        {{"filters", "cubic", "--width", "1"}, 2, "the smallest that exists has 3 taps"},
        {{"filters", "--mask", "1/2 1/2 1/2 1/2"}, 3, "not injective"},
        {{"filters", "--mask", "1/2 x"}, 3, "number 2"},
        {{"filters", "cubic", "--boundary", "--json", "-"}, 2, "--boundary"},
        {{"curve-levels", (folder / "short.txt").string(), "-o", out},
         3,
         "has 3 points; 6 levels of an open dlg-refined curve need at least 34"},
        {{"curve-levels", (folder / "nan.txt").string(), "-o", out}, 3, "line 2"},
        {{"curve-levels", coast, "-o", out, "--scheme", "best"}, 2, "dlg-trial, dlg-refined, dlg-optimal"},
        {{"curve-levels", coast, "-o", out, "--mask", "2 1 -1", "--limit"},
         2,
         "--limit: 'mask': has no limit positions"},
        {{"relief", terrain, "-o", out, "--scheme", "loop-like:1/2,0", "--limit"},
         2,
         "--limit: 'loop-like:1/2,0': has no limit positions"},
        {{"curve-levels", coast, "-o", out, "--width", "7"}, 2, "--mask"},
        {{"curve-levels", (folder / "none.svg").string(), "-o", out}, 3, "cannot be opened"},
        {{"relief", terrain, "-o", out, "--scheme", "litke"}, 2, "loop-like:ALPHA,GAMMA"},
        {{"relief", terrain, "-o", out, "--depth", "9"}, 3, "too small for 9 levels"},
        {{"relief", coast, "-o", out}, 3, ".npy .asc .png .tif"},
        {{"subdivide", (folder / "cube.off").string(), "--depth", "15", "-o", out + ".ply"},
         3,
         "cube.off: --depth 15 makes 6.44e+09 faces, about 902 GB of memory, over the limit of "},
    };
    for (const auto& each : cases) {
        const auto result = isowave(each.arguments);
        EXPECT_EQ(result.exitCode, each.code) << each.says;
        EXPECT_THAT(result.err, HasSubstr(each.says));
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_FALSE(fs::exists(out)) << each.says;
    }
}

}  // namespace
}  // namespace isowave::tools_test
