// isowave view and lod --view: which inputs make a page, and what is said of those that do not.
#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

#include <cstring>

namespace isowave::tools_test {
namespace {

const std::string kData = std::string(ISOWAVE_TEST_DATA) + "/";
const std::string kPart = kData + "meshes/couplingdown.off";

bool hasPages(const Folder& folder) {
    const std::string page = (folder / "probe.html").string();
    return isowave({"view", kPart, "-o", page}).exitCode == 0;
}

#define SKIP_WITHOUT_PAGES(folder) \
    if (!hasPages(folder)) GTEST_SKIP() << "three.js was not there when this build was configured"

nlohmann::json documentOf(const fs::path& page) {
    const std::string html = contentOf(page), begin = "id=\"document\">";
    const auto from = html.find(begin) + begin.size();
    return nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
}

std::vector<std::string> namesIn(const nlohmann::json& document) {
    std::vector<std::string> names;
    for (const auto& level : document["levels"]) names.push_back(level["facts"]["name"]);
    return names;
}

void expectRefusal(const std::vector<std::string>& arguments, int code, const std::string& words) {
    const Result result = isowave(arguments);
    EXPECT_EQ(result.exitCode, code) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
}

TEST(View, OfAFolderHasTheReportsNumbers) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string part = (folder / "part").string(), page = (folder / "part.html").string();
    succeed({"lod", kPart, "--voxels", "32", "--levels", "0..2", "-o", part});
    succeed({"view", part, "-o", page});
    const nlohmann::json report = jsonFile(folder / "part/report.json"), document = documentOf(page);
    ASSERT_EQ(namesIn(document), (std::vector<std::string>{"L0", "L1", "L2"}));
    for (int i = 0; i < 3; ++i) {
        const auto& facts = document["levels"][i]["facts"];
        const auto& level = report["levels"][i];
        EXPECT_EQ(facts["triangles"], level["triangles"]);
        EXPECT_EQ(facts["handles"], level["genus"]);
        EXPECT_EQ(facts["rms"], level["rms_to_level0"]);
        EXPECT_EQ(facts["max"], level["max_to_level0"]);
        if (i == 0) continue;
        // The page's own sample, which colours and histogram are made of, is not the report's: it takes no more than the
        // corners and centroids of large triangles, too.
        const auto& own = document["levels"][i]["distance"];
        EXPECT_NEAR(own["rms"].get<double>() / level["rms_to_level0"].get<double>(), 1, 0.15);
        EXPECT_NEAR(own["max"].get<double>() / level["max_to_level0"].get<double>(), 1, 0.1);
    }
}

TEST(View, OfLodIsThePageOfItsFolder) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string part = (folder / "part").string();
    succeed({"lod", kPart, "--voxels", "32", "--levels", "0..2", "--triangles", "500", "--view", "-o", part});
    EXPECT_EQ(jsonFile(folder / "part/report.json")["view"], "part.html");
    const nlohmann::json document = documentOf(folder / "part/part.html");
    EXPECT_EQ(namesIn(document), (std::vector<std::string>{"L0", "L1", "L2", "T500"}));
    const std::string again = (folder / "again.html").string();
    succeed({"view", part, "-o", again});
    const nlohmann::json other = documentOf(again);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(document["levels"][i]["facts"], other["levels"][i]["facts"]) << i;
}

TEST(View, WithoutLevel0MeasuresFromTheFirstLevelThatIsThere) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string part = (folder / "part").string(), page = (folder / "part.html").string();
    succeed({"lod", kPart, "--voxels", "32", "--levels", "1..2", "-o", part});
    succeed({"view", part, "-o", page});
    const nlohmann::json level = documentOf(page)["levels"][1];
    EXPECT_NE(level["facts"]["rms"], jsonFile(folder / "part/report.json")["levels"][1]["rms_to_level0"]);
    EXPECT_EQ(level["facts"]["rms"], level["distance"]["rms"]);
}

TEST(View, OfAPyramidHasAllItsLevels) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string pyramid = (folder / "part.pyramid.vdb").string(), page = (folder / "p.html").string();
    succeed({"analyse", kPart, "--voxels", "32", "-o", pyramid});
    succeed({"view", pyramid, "-o", page});
    const nlohmann::json document = documentOf(page);
    EXPECT_EQ(document["title"], "part");
    EXPECT_GE(document["levels"].size(), 4u);
    EXPECT_EQ(document["levels"][0]["facts"]["rms"], 0);
}

// Level 0 of a pyramid is put together of its steps, that of a packed solid is what was packed: they differ by rounding.
TEST(View, OfAPackedSolidIsThatOfItsPyramid) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string pyramid = (folder / "part.pyramid.vdb").string(),
                      packed = (folder / "part.iwz").string();
    const std::string page = (folder / "p.html").string(), other = (folder / "q.html").string();
    succeed({"analyse", kPart, "--voxels", "32", "-o", pyramid});
    succeed({"pack", kPart, "--voxels", "32", "-o", packed});
    succeed({"view", pyramid, "-o", page});
    succeed({"view", packed, "-o", other});
    const nlohmann::json a = documentOf(page), b = documentOf(other);
    EXPECT_EQ(b["title"], "part");
    EXPECT_EQ(namesIn(b), namesIn(a));
    EXPECT_EQ(b["levels"][0]["triangles"], a["levels"][0]["triangles"]);
    for (std::size_t i = 0; i < a["levels"].size(); ++i) {
        const nlohmann::json x = a["levels"][i]["facts"], y = b["levels"][i]["facts"];
        EXPECT_EQ(y["handles"], x["handles"]);
        EXPECT_NEAR(y["volume"], x["volume"].get<double>(), 0.05 * x["volume"].get<double>());
    }
}

TEST(View, OfSeveralMeshesHasARowEach) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string page = (folder / "two.html").string();
    succeed({"view", kPart, kData + "meshes/pinion.off", "-o", page});
    EXPECT_EQ(namesIn(documentOf(page)), (std::vector<std::string>{"couplingdown.off", "pinion.off"}));
}

TEST(View, OfCurvesAndOfDetailsHasTheirLevels) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string africa = (folder / "africa").string(), page = (folder / "a.html").string();
    for (const char* format : {"geojson", "svg", "txt"}) {
        succeed({"curves", kData + "curves2d/africa.geojson", "--pixels", "64", "--format", format, "-o",
                 africa});
        succeed({"view", africa, "-o", page});
        EXPECT_TRUE(documentOf(page)["planar"]) << format;
        EXPECT_GE(documentOf(page)["levels"].size(), 5u) << format;
        fs::remove_all(africa);
    }
    succeed({"curves", kData + "curves2d/africa.geojson", "--pixels", "64", "--steps", "0..3", "-o", africa});
    succeed({"view", africa, "-o", page});
    EXPECT_EQ(namesIn(documentOf(page)), (std::vector<std::string>{"L0", "L0a", "L1", "L1a"}));
    const std::string details = (folder / "anchor.details").string();
    succeed({"reverse", kData + "meshes/anchor_semiregular_tri.off", "--scheme", "loop", "-o",
             (folder / "b.obj").string(), "--details", details});
    succeed({"view", details, "-o", page});
    EXPECT_EQ(namesIn(documentOf(page)).back(), "base");
}

TEST(View, TheSameBytesForAnyNumberOfThreads) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string one = (folder / "one.html").string(), more = (folder / "more.html").string();
    succeed({"view", kPart, kData + "meshes/pinion.off", "--threads", "1", "-o", one});
    succeed({"view", kPart, kData + "meshes/pinion.off", "-o", more});
    EXPECT_EQ(contentOf(one), contentOf(more));
}

TEST(View, RefusesInOneLineAndLeavesNothing) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    const std::string page = (folder / "page.html").string();
    fs::create_directory(folder / "empty");
    std::ofstream(folder / "other.json") << "{}";
    std::ofstream(folder / "names.json")
        << R"({"version":1,"input":{},"levels":[{"step":0,"file":"../../etc/passwd"}]})";
    std::ofstream(folder / "lost.json")
        << R"({"version":1,"input":{},"levels":[{"step":0,"file":"lost.ply"}]})";
    std::ofstream(folder / "words.json")
        << R"({"version":1,"input":7,"levels":[{"step":"a","file":"lost.ply"}]})";
    std::ofstream(folder / "coast.iwc") << "ISOWAVEC";
    const auto before = folder.snapshot();
    expectRefusal({"view", (folder / "coast.iwc").string(), "-o", page}, 3, "is a pyramid of curves");
    expectRefusal({"view", (folder / "coast.iwc").string(), "-o", page}, 3, "isowave curves ");
    expectRefusal({"view", "-o", page}, 2, "expects INPUT...");
    expectRefusal({"view", kPart}, 2, "-o is missing");
    expectRefusal({"view", kPart, "-o", (folder / "page.ply").string()}, 2, ".html");
    expectRefusal({"view", (folder / "none.ply").string(), "-o", page}, 3, "none.ply");
    expectRefusal({"view", (folder / "empty").string(), "-o", page}, 3,
                  "holds neither report.json nor levels");
    expectRefusal({"view", kData + "ct/cranium_crop.nrrd", "-o", page}, 3, "isowave lod first");
    expectRefusal({"view", kPart, kData + "curves2d/africa.geojson", "-o", page}, 2, "no mesh file");
    expectRefusal({"view", (folder / "other.json").string(), "-o", page}, 3, "no report");
    expectRefusal({"view", (folder / "names.json").string(), "-o", page}, 3, "without folders");
    expectRefusal({"view", (folder / "lost.json").string(), "-o", page}, 3, "lost.ply");
    expectRefusal({"view", (folder / "words.json").string(), "-o", page}, 3, "words.json");
    EXPECT_EQ(folder.snapshot(), before);
}

TEST(View, NeverReplacesItsInput) {
    const Folder folder;
    SKIP_WITHOUT_PAGES(folder);
    fs::copy_file(kPart, folder / "part.off");
    fs::create_hard_link(folder / "part.off", folder / "part.html");
    expectRefusal({"view", (folder / "part.off").string(), "-o", (folder / "part.html").string()}, 2,
                  "part.html");
}

// ---- lod --glb-lods

TEST(GlbLodsOption, PutsAllLevelsIntoOneFileThatTheReportNames) {
    const Folder folder;
    const std::string part = (folder / "part").string();
    succeed({"lod", kPart, "--voxels", "32", "--levels", "0..2", "--glb-lods", "quantized", "-o", part});
    EXPECT_EQ(jsonFile(folder / "part/report.json")["glb_lods"], "part_lods.glb");
    const std::string glb = contentOf(folder / "part/part_lods.glb");
    std::uint32_t length = 0;
    std::memcpy(&length, glb.data() + 12, 4);
    const auto gltf = nlohmann::json::parse(glb.substr(20, length));
    EXPECT_EQ(gltf["nodes"].size(), 3u);
    EXPECT_EQ(gltf["nodes"][0]["extras"]["MSFT_screencoverage"], nlohmann::json::array({0.5, 0.25, 0.125}));
}

nlohmann::json gltfOf(const fs::path& path) {
    const std::string glb = contentOf(path);
    std::uint32_t length = 0;
    std::memcpy(&length, glb.data() + 12, 4);
    return nlohmann::json::parse(glb.substr(20, length));
}

// Colours of all meshes of a run can be compared: of the levels' files, of those by budget and of the one of all levels.
TEST(GlbLodsOption, AllFilesOfARunHaveOneRangeOfColours) {
    const Folder folder;
    const std::string part = (folder / "part").string();
    succeed({"lod", kPart, "--voxels", "32", "--levels", "0..2", "--triangles", "300", "--glb-lods", "float",
             "--colour", "distance", "--format", "glb", "-o", part});
    const nlohmann::json report = jsonFile(folder / "part/report.json");
    const auto range = report["colour_range"].get<double>();
    EXPECT_LE(range, 1.0001 * std::max(report["levels"][2]["max_to_level0"].get<double>(),
                                       report["budgets"][0]["max_to_level0"].get<double>()));
    EXPECT_GT(range, 0);
    const nlohmann::json lods = gltfOf(folder / "part/part_lods.glb");
    ASSERT_EQ(lods["meshes"].size(), 3u);
    for (const auto& mesh : lods["meshes"]) EXPECT_EQ(mesh["extras"]["distance_of_last_colour"], range);
    for (const char* name : {"part_L0.glb", "part_L1.glb", "part_L2.glb", "part_T300.glb"})
        EXPECT_EQ(gltfOf(folder / "part" / name)["meshes"][0]["extras"]["distance_of_last_colour"], range)
            << name;
}

TEST(GlbLodsOption, NeedsLevels) {
    const Folder folder;
    expectRefusal(
        {"lod", kPart, "--triangles", "500", "--glb-lods", "float", "-o", (folder / "part").string()}, 2,
        "give --levels too");
}

}  // namespace
}  // namespace isowave::tools_test
