// `isowave curves`, through the program itself.
#include <gmock/gmock.h>

#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using testing::HasSubstr;
using Arguments = std::vector<std::string>;

const std::string kAfrica = ISOWAVE_TEST_DATA "/curves2d/africa.geojson";
const std::string kKeys = ISOWAVE_TEST_DATA "/curves2d/keyring.png";

Arguments curves(const std::string& input, const Folder& folder, Arguments more = {}) {
    Arguments arguments{"curves", input, "-o", (folder / "out/map").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(CurvesCommand, WritesOneFileALevelATableASheetAndAReport) {
    const Folder folder;
    const Result result =
        isowave(curves(kAfrica, folder,
                       {"--pixels", "120", "--threads", "1", "--format", "geojson", "--table", "--sheet",
                        (folder / "sheet.svg").string(), "--json", (folder / "report.json").string()}));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("step"));
    EXPECT_THAT(result.out, HasSubstr("L0a"));
    const auto report = nlohmann::json::parse(contentOf(folder / "report.json"));
    ASSERT_GT(report["steps"].size(), 8u);
    std::size_t files = 0;
    for (const auto& step : report["steps"]) {
        if (step["file"].is_null()) continue;
        ++files;
        EXPECT_TRUE(fs::exists(folder / "out/map" / step["file"].get<std::string>()));
    }
    EXPECT_GT(files, 4u);
    EXPECT_EQ(report["steps"][0]["file"], "map_L0.geojson");
    EXPECT_THAT(contentOf(folder / "sheet.svg"), HasSubstr(">L0</text>"));
}

TEST(CurvesCommand, NoSheetIsLeftBehindWhereTheReportCannotBeWritten) {
    const Folder folder;
    const fs::path sheet = folder / "sheet.svg";
    const Result result = isowave(
        curves(kAfrica, folder, {"--pixels", "120", "--sheet", sheet.string(), "--json", "/dev/full"}));
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_FALSE(fs::exists(sheet));
    EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(CurvesCommand, EveryFormatAndSmoothCurves) {
    for (const char* format : {"svg", "geojson", "png", "txt"}) {
        const Folder folder;
        const Result result = isowave(curves(kKeys, folder, {"--format", format, "--levels", "0..1"}));
        ASSERT_EQ(result.exitCode, 0) << result.err;
        EXPECT_TRUE(fs::exists(folder / ("out/map/map_L1." + std::string(format))));
        EXPECT_FALSE(fs::exists(folder / ("out/map/map_L2." + std::string(format))));
    }
    const Folder folder;
    const Result smooth = isowave(curves(
        kKeys, folder,
        {"--smooth", "--flatness", "0.05", "--levels", "0..2", "--json", (folder / "smooth.json").string()}));
    ASSERT_EQ(smooth.exitCode, 0);
    EXPECT_THAT(smooth.err, HasSubstr("the smooth curves stay within 0.0"));
    const auto said = jsonFile(folder / "smooth.json")["smooth"];
    EXPECT_LE(said["deviation"], 0.05);
    EXPECT_THAT(contentOf(folder / "out/map/map_L0.svg"), HasSubstr("C"));
}

TEST(CurvesCommand, HoldsThinPartsUnlessToldNotTo) {
    const Folder folder;
    for (const std::string hold : {"local", "none"}) {
        const Result result =
            isowave({"curves", kKeys, "-o", (folder / hold).string(), "--hold", hold, "--table", "--levels",
                     "0..3", "--json", (folder / (hold + ".json")).string()});
        ASSERT_EQ(result.exitCode, 0) << result.err;
        EXPECT_THAT(result.out, HasSubstr("kept %"));
    }
    const auto local = jsonFile(folder / "local.json"), none = jsonFile(folder / "none.json");
    EXPECT_EQ(local["hold"], "local");
    EXPECT_EQ(none["hold"], "none");
    EXPECT_TRUE(none["steps"][6]["hold"].is_null());
    EXPECT_TRUE(local["steps"][5]["hold"].is_null());
    const auto& hold = local["steps"][6]["hold"];
    EXPECT_GE(hold["kept"], 0.995);
    EXPECT_GT(hold["samples"], 1000);
    EXPECT_EQ(hold["sampling"], 4);
    EXPECT_GT(hold["changed"], 1000);
    EXPECT_LE(local["steps"][6]["rings"], local["steps"][0]["rings"]);
    EXPECT_GT(none["steps"][6]["rings"], none["steps"][0]["rings"]);
}

TEST(CurvesCommand, WritesHalfStepsByTheirNames) {
    const Folder folder;
    const Result result =
        isowave(curves(kAfrica, folder,
                       {"--pixels", "120", "--steps", "1..4", "--format", "geojson", "--sheet",
                        (folder / "sheet.svg").string(), "--json", (folder / "report.json").string()}));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("the steps between them do not"));
    const auto report = jsonFile(folder / "report.json");
    std::vector<std::string> files;
    for (const auto& step : report["steps"]) files.push_back(step["file"]);
    EXPECT_THAT(files, testing::ElementsAre("map_L0a.geojson", "map_L1.geojson", "map_L1a.geojson",
                                            "map_L2.geojson"));
    for (const std::string& file : files) EXPECT_TRUE(fs::exists(folder / ("out/map/" + file))) << file;
    EXPECT_FALSE(fs::exists(folder / "out/map/map_L0.geojson"));
    const auto half = jsonFile(folder / "out/map/map_L1a.geojson");
    EXPECT_EQ(half["features"][0]["properties"]["name"], "map L1a");
    EXPECT_THAT(contentOf(folder / "sheet.svg"), HasSubstr(">L1a</text>"));
    // A level is the same file whether it was asked for as a level or as a step.
    const std::string step = contentOf(folder / "out/map/map_L2.geojson");
    ASSERT_EQ(isowave(curves(kAfrica, folder, {"--pixels", "120", "--levels", "2", "--format", "geojson"}))
                  .exitCode,
              0);
    EXPECT_TRUE(contentOf(folder / "out/map/map_L2.geojson") == step);
}

// The result of `input` with all of these options, its report without what may differ, as text.
std::map<std::string, std::string> resultOf(const std::string& input, const Folder& folder,
                                            Arguments options) {
    const fs::path report = folder / "out/map/report.json";
    options.insert(options.end(), {"--json", report.string()});
    fs::remove_all(folder / "out");
    const Result result = isowave(curves(input, folder, options));
    EXPECT_EQ(result.exitCode, 0) << result.err;
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder / "out/map"))
        files[entry.path().filename().string()] = contentOf(entry.path());
    auto json = nlohmann::json::parse(files["report.json"]);
    EXPECT_EQ(json["input"]["path"], input);
    json["input"].erase("path");
    json.erase("peak_memory_bytes");
    json.erase("remarks");
    files["report.json"] = json.dump();
    return files;
}

TEST(CurvesCommand, APyramidTakesThePlaceOfItsInputToTheByte) {
    const std::vector<std::pair<std::string, Arguments>> inputs = {
        {kAfrica, {"--pixels", "120", "--band", "1.5"}}, {kKeys, {"--invert"}}};
    const std::vector<Arguments> draw = {{"--format", "geojson"},
                                         {"--steps", "0..5", "--format", "txt"},
                                         {"--smooth", "--levels", "0..2"},
                                         {"--hold", "none", "--format", "png"}};
    const Folder folder;
    const std::string pyramid = (folder / "deep/p.iwc").string();
    for (const auto& [input, options] : inputs)
        for (const Arguments& how : draw) {
            Arguments all = options;
            all.insert(all.end(), how.begin(), how.end());
            const auto plain = resultOf(input, folder, all);
            EXPECT_GT(plain.size(), 3u);
            all.insert(all.end(), {"--pyramid", pyramid});
            EXPECT_TRUE(resultOf(input, folder, all) == plain) << input << " " << how[0];
            EXPECT_TRUE(resultOf(pyramid, folder, how) == plain) << input << " " << how[0];
        }
}

TEST(CurvesCommand, RefusesWhatAPyramidHasNoUseFor) {
    const Folder folder;
    const std::string file = (folder / "p.iwc").string();
    ASSERT_EQ(isowave(curves(kAfrica, folder, {"--pixels", "60", "--pyramid", file})).exitCode, 0);
    const std::string bytes = contentOf(file);
    std::ofstream(folder / "half.iwc", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    std::ofstream(folder / "other.iwc") << "some text";
    struct {
        std::string input;
        Arguments more;
        int exitCode;
        std::string says;
    } all[] = {{file, {"--pixels", "64"}, 2, "which is a pyramid, fitted already"},
               {file, {"--invert"}, 2, "--invert has no meaning"},
               {file, {"--fit", "binary"}, 2, "--fit has no meaning"},
               {file, {"--half-width", "5"}, 2, "--half-width has no meaning"},
               {file, {"--pyramid", file}, 2, "p.iwc"},
               {file, {"--levels", "1", "--steps", "2"}, 2, "--levels and --steps exclude each other"},
               {file, {"--steps", "90.."}, 3, "ends at step"},
               {kAfrica, {"--half-width", "65"}, 2, "--half-width 65 is more than 64 pixels"},
               {kAfrica, {"--pyramid", (folder / "p.vdb").string()}, 2, "does not end in .iwc"},
               {(folder / "half.iwc").string(), {}, 3, "it is truncated"},
               {(folder / "other.iwc").string(), {}, 3, "is no pyramid of curves"},
               {(folder / "none.iwc").string(), {}, 3, "none.iwc"}};
    for (const char* bad : {"half.iwc", "other.iwc", "none.iwc"})
        EXPECT_EQ(isowave({"info", (folder / bad).string()}).exitCode, 3) << bad;
    const auto snapshot = folder.snapshot();
    for (const auto& bad : all) {
        Arguments arguments{"curves", bad.input, "-o", (folder / "new").string()};
        arguments.insert(arguments.end(), bad.more.begin(), bad.more.end());
        const Result refused = isowave(arguments);
        EXPECT_EQ(refused.exitCode, bad.exitCode) << bad.says << refused.err;
        EXPECT_THAT(refused.err, HasSubstr(bad.says));
        EXPECT_EQ(refused.errorLines(), 1) << refused.err;
        EXPECT_EQ(folder.snapshot(), snapshot) << bad.says;
    }
}

// Of the file alone, what the command that wrote it told of its input.
TEST(CurvesCommand, InfoTellsOfAPyramidWhatCurvesTells) {
    for (const auto& [input, options] : {std::pair<std::string, Arguments>{kAfrica, {"--pixels", "60"}},
                                         {kKeys, {"--invert", "--fit", "binary"}}}) {
        const Folder folder;
        const std::string file = (folder / "p.iwc").string();
        Arguments all{"--steps", "0..", "--json", "-", "--pyramid", file};
        all.insert(all.end(), options.begin(), options.end());
        nlohmann::json told = isowave(curves(input, folder, all)).json(),
                       info = isowave({"info", file, "--json", "-"}).json();
        for (auto& step : told["steps"]) step.erase("file");
        EXPECT_EQ(info["steps"], told["steps"]);
        for (const char* key : {"fit", "coefficients_stored", "control_points"})
            EXPECT_EQ(info[key], told[key]);
        for (const char* key : {"kind", "pixel"}) EXPECT_EQ(info["input"][key], told["input"][key]);
        EXPECT_EQ(info["kind"], "curves");
        EXPECT_EQ(info["path"], file);
        EXPECT_EQ(info["file_bytes"], contentOf(file).size());
        EXPECT_EQ(info["input"]["y_up"], input == kAfrica);
        const auto extent = info["input"]["extent"].get<std::array<std::array<double, 2>, 2>>();
        EXPECT_LT(extent[0][0], extent[1][0]);
        EXPECT_LT(extent[0][1], extent[1][1]);
        const std::string text = isowave({"info", file}).out;
        EXPECT_THAT(text, HasSubstr("pyramid of curves of "));
        EXPECT_THAT(text, HasSubstr(told["input"]["kind"].get<std::string>()));
        EXPECT_THAT(text, HasSubstr("L1a"));
        EXPECT_THAT(text, HasSubstr(" on disk"));
    }
}

TEST(CurvesCommand, AddsAndCutsPolygonsInTheirOrder) {
    const Folder folder;
    const auto write = [&](const char* name, const char* ring) {
        std::ofstream(folder / name) << ring;
        return (folder / name).string();
    };
    const std::string plate = write("plate.txt", "0 0\n100 0\n100 50\n0 50\n"),
                      boss = write("boss.txt", "60 30\n90 30\n90 80\n60 80\n"),
                      hole = write("hole.txt", "70 40\n80 40\n80 70\n70 70\n"),
                      inner = write("inner.txt", "73 43\n77 43\n77 65\n73 65\n"),
                      far = write("far.txt", "200 200\n210 200\n210 210\n");
    const auto area = [&](const std::string& input, const Arguments& more) {
        Arguments all{"--levels", "0", "--json", (folder / "r.json").string()};
        all.insert(all.end(), more.begin(), more.end());
        const Result result = isowave(curves(input, folder, all));
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return jsonFile(folder / "r.json")["steps"][0]["area"].get<double>();
    };
    const std::string pyramid = (folder / "p.iwc").string();
    const double plain = area(plate, {"--pixels", "400", "--pyramid", pyramid});
    EXPECT_NEAR(plain, 5000, 10);
    EXPECT_NEAR(area(plate, {"--pixels", "400", "--add", boss, "--cut", hole}), 5000 + 900 - 300, 15);
    EXPECT_NEAR(area(plate, {"--pixels", "400", "--cut", hole, "--add", boss}), 5000 + 900, 15);
    const std::string edited = (folder / "q.iwc").string();
    EXPECT_NEAR(area(pyramid, {"--add", boss, "--cut", hole, "--edit-level", "2", "--pyramid", edited}), 5600,
                30);
    EXPECT_NEAR(area(edited, {}), 5600, 30);
    const auto before = folder.snapshot();
    const struct {
        Arguments more;
        int code;
        const char* says;
    } cases[] = {{{"--cut", far}, 3, "far.txt: cuts nothing away"},
                 {{"--cut", plate}, 0, ""},
                 {{"--add", hole, "--add", inner}, 3, "inner.txt: adds nothing"},
                 {{"--edit-level", "1"}, 2, "--edit-level: belongs to --add and --cut"},
                 {{"--add", boss, "--edit-level", "-1"}, 2, "--edit-level"},
                 {{"--add", (folder / "none.txt").string()}, 3, "none.txt"},
                 {{"--add", boss, "--pyramid", boss}, 2, "boss.txt"}};
    for (const auto& bad : cases) {
        Arguments all{"curves", edited, "-o", (folder / "new/x").string()};
        all.insert(all.end(), bad.more.begin(), bad.more.end());
        const Result result = isowave(all);
        if (bad.code == 0) {
            EXPECT_EQ(result.exitCode, 0) << result.err;  // the rest of the boss is left
            fs::remove_all(folder / "new");
            continue;
        }
        EXPECT_EQ(result.exitCode, bad.code) << bad.says << result.err;
        EXPECT_THAT(result.err, HasSubstr(bad.says));
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_EQ(folder.snapshot(), before) << bad.says;
    }
}

struct Bad {
    std::string name, content;
    Arguments more;
    int exitCode;
    std::string says;
};

TEST(CurvesCommand, BadInputGivesOneLineItsExitCodeAndNoFiles) {
    const std::vector<Bad> all = {
        {"a.png", "no picture", {}, 3, "neither PNG"},
        {"a.png", "", {}, 3, "is empty"},
        {"a.pgm", "P5\n0 0\n255\n", {}, 3, "0 x 0 pixels"},
        {"a.pgm", "P2 2 2 255 5 5 5 5", {}, 3, "every pixel is 5"},
        {"a.pgm", "P2 2 2 255 5 5 5 6", {"--iso", "200"}, 3, "from 5 to 6"},
        {"a.pgm", "P2 2 2 255 5 5", {}, 3, "truncated"},
        {"a.geojson",
         "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1e300,1],[2,2]]]}",
         {},
         3,
         "polygon 0, ring 0"},
        {"a.geojson", "{\"type\":\"LineString\",\"coordinates\":[[0,0],[1,1]]}", {}, 3, "no polygon"},
        {"a.geojson", "{\"type\":\n\"Polygon\" oops}", {}, 3, "a.geojson: line 2, column 11: found 'oops}'"},
        {"a.txt", "0 0\n1 x\n", {}, 3, "line 2"},
        {"a.txt", "0 0\n1 0\n1 1\n", {"--levels", "90..95"}, 3, "ends at level"},
        {"a.txt", "0 0\n1 0\n1 1\n", {"--pixels", "0"}, 2, "--pixels"},
        {"a.txt", "0 0\n1 0\n1 1\n", {"--invert"}, 2, "--invert has no meaning for"},
        {"a.txt", "0 0\n1 0\n1 1\n", {"--iso", "3"}, 2, "which holds polygons"},
        {"a.pgm", "P2 2 2 255 5 5 5 6", {"--pixels", "64"}, 2, "which is an image"},
        {"a.txt", "0 0\n1 0\n1 1\n", {"--smooth", "--format", "geojson"}, 2, "--smooth"},
        {"a.txt", "0 0\n1 0\n1 1\n", {"--format", "stl"}, 2, "--format"},
        {"a.txt", "0 0\n1 0\n1 1\n", {"--hold", "shift"}, 2, "--hold"},
    };
    for (const Bad& bad : all) {
        const Folder folder;
        std::ofstream(folder / bad.name, std::ios::binary) << bad.content;
        const auto before = folder.snapshot();
        const Result result = isowave(curves((folder / bad.name).string(), folder, bad.more));
        EXPECT_EQ(result.exitCode, bad.exitCode) << bad.name << ": " << bad.content;
        EXPECT_THAT(result.err, HasSubstr(bad.says));
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
        EXPECT_EQ(folder.snapshot(), before) << bad.says;
    }
    const Folder folder;
    EXPECT_EQ(isowave(curves((folder / "none.png").string(), folder)).exitCode, 3);
}

}  // namespace
}  // namespace isowave::tools_test
