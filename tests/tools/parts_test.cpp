// Several inputs in one go: each is a job of its own.
#include <gmock/gmock.h>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using ::testing::HasSubstr;

// Tori a.stl, b.stl, ... in `in`.
std::vector<std::string> tori(const Folder& folder, int count) {
    fs::create_directories(folder / "in");
    std::vector<std::string> paths;
    for (int i = 0; i < count; ++i) {
        const fs::path path = folder / "in" / (std::string(1, static_cast<char>('a' + i)) + ".stl");
        writeStl(path, torus(10, 3 + 0.2 * i, 24, 12));
        paths.push_back(path.string());
    }
    return paths;
}

std::vector<std::string> lod(std::vector<std::string> inputs, const fs::path& out,
                             const std::vector<std::string>& options = {}) {
    inputs.insert(inputs.begin(), "lod");
    for (const std::string& word : {std::string("--voxels"), std::string("24"), std::string("--quiet"),
                                    std::string("-o"), out.string()})
        inputs.push_back(word);
    inputs.insert(inputs.end(), options.begin(), options.end());
    return inputs;
}

// The meshes in a folder, name -> bytes.
std::map<std::string, std::string> meshesIn(const fs::path& folder) {
    std::map<std::string, std::string> meshes;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".ply")
            meshes[entry.path().filename().string()] = contentOf(entry.path());
    return meshes;
}

TEST(Parts, EachGetsTheFilesOfARunOfItsOwn) {
    const Folder folder;
    const std::vector<std::string> inputs = tori(folder, 3);
    const Result all = succeed(lod(inputs, folder / "all"));
    EXPECT_EQ(all.err, "");
    EXPECT_THAT(all.out, HasSubstr("3 of 3 parts done, 0 failed"));
    for (const std::string name : {"a", "b", "c"}) {
        succeed(lod({(folder / "in" / (name + ".stl")).string()}, folder / "alone" / name));
        const auto meshes = meshesIn(folder / "all" / name);
        EXPECT_GE(meshes.size(), 3u);
        EXPECT_EQ(meshes, meshesIn(folder / "alone" / name));
        auto together = jsonFile(folder / "all" / name / "report.json");
        auto alone = jsonFile(folder / "alone" / name / "report.json");
        EXPECT_EQ(together.at("input"), alone.at("input"));
        EXPECT_EQ(together.at("fit"), alone.at("fit"));
        EXPECT_EQ(together.at("control_points"), alone.at("control_points"));
    }
}

TEST(Parts, OneThatFailsDoesNotStopTheOthers) {
    const Folder folder;
    std::vector<std::string> inputs = tori(folder, 2);
    std::ofstream(folder / "in" / "bad.stl") << "solid nothing\nendsolid\n";
    inputs.insert(inputs.begin() + 1, (folder / "in" / "bad.stl").string());
    const Result result = isowave(lod(inputs, folder / "out", {"--json", (folder / "all.json").string()}));
    EXPECT_EQ(result.exitCode, 3);
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("bad.stl"));
    EXPECT_FALSE(fs::exists(folder / "out" / "bad"));
    EXPECT_TRUE(fs::exists(folder / "out" / "a" / "report.json"));
    EXPECT_TRUE(fs::exists(folder / "out" / "b" / "report.json"));

    const auto json = jsonFile(folder / "all.json");
    EXPECT_EQ(json.at("version"), 1);
    EXPECT_EQ(json.at("done"), 2);
    EXPECT_EQ(json.at("failed"), 1);
    ASSERT_EQ(json.at("parts").size(), 3u);
    EXPECT_EQ(json["parts"][0]["exit_code"], 0);
    EXPECT_TRUE(json["parts"][0]["error"].is_null());
    EXPECT_EQ(json["parts"][0]["input"], inputs[0]);
    EXPECT_EQ(json["parts"][0]["output"], (folder / "out" / "a").string());
    const auto report = jsonFile(json["parts"][0]["report"].get<std::string>());
    std::int64_t drawn = 0;
    for (const auto& level : report.at("levels")) drawn += level.at("triangles") != 0;
    EXPECT_EQ(json["parts"][0]["levels"], drawn);
    EXPECT_FALSE(json["parts"][0]["remarks"].empty());
    EXPECT_EQ(json["parts"][1]["exit_code"], 3);
    EXPECT_THAT(json["parts"][1]["error"].get<std::string>(), HasSubstr("bad.stl"));
}

TEST(Parts, WhatCannotBeWrittenIsExitCode1) {
    const Folder folder;
    const std::vector<std::string> inputs = tori(folder, 2);
    fs::create_directories(folder / "out");
    std::ofstream(folder / "out" / "a") << "in the way";
    const Result result = isowave(lod(inputs, folder / "out"));
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_EQ(contentOf(folder / "out" / "a"), "in the way");
    EXPECT_TRUE(fs::exists(folder / "out" / "b" / "report.json"));
}

TEST(Parts, TwoOfOneNameAreRefusedBeforeAnythingIsRead) {
    const Folder folder;
    const std::vector<std::string> inputs = tori(folder, 1);
    fs::create_directories(folder / "other");
    std::ofstream(folder / "other" / "a.obj") << "never read";
    const auto before = folder.snapshot();
    const Result result = isowave(lod({inputs[0], (folder / "other" / "a.obj").string()}, folder / "out"));
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.errorLines(), 1);
    EXPECT_THAT(result.err, HasSubstr("would both go to"));
    EXPECT_EQ(folder.snapshot(), before);
}

TEST(Parts, AListOfOneGetsAFolderBelowTheOutputToo) {
    const Folder folder;
    const std::vector<std::string> inputs = tori(folder, 2);
    std::ofstream(folder / "list.txt") << inputs[0] << "\r\n\n";
    succeed(lod({"--list", (folder / "list.txt").string()}, folder / "listed"));
    EXPECT_TRUE(fs::exists(folder / "listed" / "a" / "a_L0.ply"));
    succeed(lod({inputs[1], "--list", (folder / "list.txt").string()}, folder / "both"));
    EXPECT_TRUE(fs::exists(folder / "both" / "a" / "a_L0.ply"));
    EXPECT_TRUE(fs::exists(folder / "both" / "b" / "b_L0.ply"));
    const std::string command = "'" ISOWAVE_BINARY "' lod --voxels 24 --quiet --list - -o '" +
                                (folder / "piped").string() + "' < '" + (folder / "list.txt").string() +
                                "' > /dev/null";
    EXPECT_EQ(::system(command.c_str()), 0);
    EXPECT_TRUE(fs::exists(folder / "piped" / "a" / "a_L0.ply"));
}

TEST(Parts, AListThatIsEmptyOrMissingIsRefused) {
    const Folder folder;
    std::ofstream(folder / "empty.txt") << "\n\n";
    const Result empty = isowave(lod({"--list", (folder / "empty.txt").string()}, folder / "out"));
    EXPECT_EQ(empty.exitCode, 2);
    EXPECT_THAT(empty.err, HasSubstr("names no input"));
    const Result missing = isowave(lod({"--list", (folder / "none.txt").string()}, folder / "out"));
    EXPECT_EQ(missing.exitCode, 3);
    EXPECT_THAT(missing.err, HasSubstr("none.txt"));
    EXPECT_EQ(isowave(lod({}, folder / "out")).exitCode, 2) << "neither arguments nor a list";
}

TEST(Parts, NoResultTakesThePlaceOfAnotherInput) {
    const Folder folder;
    const std::vector<std::string> inputs = tori(folder, 1);
    fs::create_directories(folder / "out" / "a");
    writeStl(folder / "out" / "a" / "report.stl", torus(10, 4, 24, 12));
    const std::string inside = (folder / "out" / "a" / "report.stl").string();
    const auto before = folder.snapshot();
    const Result result = isowave(lod({inputs[0], inside}, folder / "out"));
    EXPECT_EQ(result.exitCode, 2) << result.err;
    EXPECT_EQ(folder.snapshot(), before);
    const Result report = isowave(lod({inputs[0], inside}, folder / "new",
                                      {"--json", (folder / "new" / "a" / "report.json").string()}));
    EXPECT_EQ(report.exitCode, 2) << report.err;
    EXPECT_EQ(folder.snapshot(), before);
    const Result meshes =
        isowave({"mesh", inputs[0], inside, "--format", "stl", "-o", (folder / "in").string()});
    EXPECT_EQ(meshes.exitCode, 2) << meshes.err;
    EXPECT_EQ(folder.snapshot(), before);
}

TEST(Parts, AnInterruptLeavesWhatWasDoneAndNothingElse) {
    const Folder folder;
    const std::vector<std::string> inputs = tori(folder, 26);
    const fs::path out = folder / "out";
    std::vector<std::string> command = lod(inputs, out);
    const Result result =
        isowave(command, {.interruptWhen = [&](pid_t) { return fs::exists(out / "b" / "report.json"); }});
    EXPECT_EQ(result.exitCode, 130) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("of 26 parts were done before and stay"));
    int folders = 0;
    for (const auto& entry : fs::directory_iterator(out)) {
        ++folders;
        EXPECT_TRUE(fs::exists(entry.path() / "report.json")) << entry.path();
    }
    EXPECT_GE(folders, 2);
    EXPECT_LT(folders, 26);
}

TEST(Parts, MeshAndAnalyseTakeSeveralInputsToo) {
    const Folder folder;
    const std::vector<std::string> inputs = tori(folder, 2);
    const std::string out = (folder / "out").string();
    succeed({"analyse", inputs[0], inputs[1], "--voxels", "24", "--quiet", "-o", out});
    const std::string a = (folder / "out" / "a.pyramid.vdb").string(),
                      b = (folder / "out" / "b.pyramid.vdb").string();
    succeed({"mesh", a, b, "--level", "1", "--format", "off", "--quiet", "-o", out});
    succeed({"mesh", b, "--level", "1", "--quiet", "-o", (folder / "alone.off").string()});
    EXPECT_EQ(contentOf(folder / "out" / "b.pyramid.off"), contentOf(folder / "alone.off"));
    EXPECT_TRUE(fs::exists(folder / "out" / "a.pyramid.off"));
}

}  // namespace
}  // namespace isowave::tools_test
