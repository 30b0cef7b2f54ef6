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

TEST(SubdivisionCommands, RefuseBadInputInOneLine) {
    const Folder folder;
    const auto out = (folder / "out").string(), terrain = (kData / "terrain" / "jacksboro.npy").string(),
               coast = (kData / "coast" / "iceland.txt").string();
    std::ofstream(folder / "short.txt") << "0 0\n1 0\n1 1\n";
    std::ofstream(folder / "nan.txt") << "0 0\n1 nan\n1 1\n";
    const struct {
        std::vector<std::string> arguments;
        int code;
        const char* says;
    } cases[] = {
        {{"filters"}, 2, "name a subdivision"},
        {{"filters", "cubic", "--mask", "1 1"}, 2, "not both"},
        {{"filters", "cubic", "--lattice", "quad"}, 2, "--lattice: says where a --mask lives"},
        {{"filters", "nurbs"}, 3, "chaikin, cubic, dlg"},
        {{"filters", "cubic", "--width", "1"}, 3, "the smallest that exists has 3 taps"},
        {{"filters", "--mask", "1/2 1/2 1/2 1/2"}, 3, "not injective"},
        {{"filters", "--mask", "1/2 x"}, 3, "number 2"},
        {{"filters", "cubic", "--boundary", "--json", "-"}, 2, "--boundary"},
        {{"curve-levels", (folder / "short.txt").string(), "-o", out},
         3,
         "has 3 points; 6 levels of an open dlg-refined curve need at least 34"},
        {{"curve-levels", (folder / "nan.txt").string(), "-o", out}, 3, "line 2"},
        {{"curve-levels", coast, "-o", out, "--scheme", "best"}, 3, "dlg-trial, dlg-refined, dlg-optimal"},
        {{"curve-levels", coast, "-o", out, "--width", "7"}, 2, "--mask"},
        {{"curve-levels", (folder / "none.svg").string(), "-o", out}, 3, "cannot be opened"},
        {{"relief", terrain, "-o", out, "--scheme", "litke"}, 3, "loop-like:ALPHA,GAMMA"},
        {{"relief", terrain, "-o", out, "--depth", "9"}, 3, "too small for 9 levels"},
        {{"relief", coast, "-o", out}, 3, ".npy .asc .png .tif"},
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
