// A result never takes the place of what it is made from, whatever the name that leads there.
#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Arguments = std::vector<std::string>;

// Every command that writes, with `place` as its result and `input` as what it reads.
std::vector<Arguments> writers(const std::string& image, const std::string& mesh, const std::string& place) {
    return {{"mesh", image, "--iso", "0", "--format", "ply", "-o", place},
            {"mesh", mesh, "--voxels", "24", "--format", "ply", "-o", place},
            {"lod", image, "--iso", "0", "-o", place},
            {"lod", image, "--iso", "0", "-o", place + "_folder", "--json", place},
            {"analyse", image, "--iso", "0", "-o", place},
            {"field", image, "--iso", "0", "-o", place},
            {"curves", image, "-o", place},
            {"curves", image, "-o", place + "_folder", "--sheet", place},
            {"curve-levels", image, "-o", place},
            {"relief", image, "-o", place}};
}

void expectRefusal(const Folder& folder, const Arguments& arguments) {
    const auto before = folder.snapshot();
    const Result result = isowave(arguments);
    const std::string shown = arguments[0] + " " + arguments.back();
    EXPECT_EQ(result.exitCode, 2) << shown << ": " << result.err;
    EXPECT_EQ(result.errorLines(), 1) << shown << ": " << result.err;
    EXPECT_NE(result.err.find("what this command reads"), std::string::npos) << shown << ": " << result.err;
    EXPECT_EQ(folder.snapshot(), before) << shown;
}

TEST(ReplacingTheInput, IsRefusedByEveryCommandThroughEveryName) {
    const Folder folder;
    const Size size{16, 16, 16};
    // One name for all kinds of input: what it holds is never looked at.
    const std::string input = (folder / "a.vdb").string();
    writeNrrd(input, size, greyBall(size, 5));
    fs::create_symlink(input, folder / "soft.vdb");
    fs::create_hard_link(input, folder / "hard.vdb");
    fs::create_directory(folder / "sub");
    for (const Arguments& arguments : writers(input, input, input)) expectRefusal(folder, arguments);
    for (const char* name : {"sub/../a.vdb", "soft.vdb", "hard.vdb"})
        expectRefusal(folder, {"analyse", input, "--iso", "0", "-o", (folder / name).string()});
    // And the other way round: the input is named through the link.
    expectRefusal(folder, {"analyse", (folder / "soft.vdb").string(), "--iso", "0", "-o", input});
}

TEST(ReplacingTheInput, IsRefusedForAMeshOfTheFolderThatIsTheInput) {
    const Folder folder;
    fs::create_directories(folder / "part");
    writePly(folder / "part/part_L0.ply", torus(10, 4));
    writePly(folder / "part/part_L2.ply", torus(10, 4));
    fs::create_symlink(folder / "part/part_L2.ply", folder / "link.ply");
    for (const char* input : {"part/part_L0.ply", "part/part_L2.ply", "link.ply"})
        expectRefusal(folder,
                      {"lod", (folder / input).string(), "--voxels", "24", "-o", (folder / "part").string()});
    // Other names beside it are no harm.
    succeed({"lod", (folder / "part/part_L0.ply").string(), "--voxels", "24", "--levels", "1..1", "-o",
             (folder / "part").string()});
}

TEST(ReplacingTheInput, IsRefusedForASliceOfAFolder) {
    const Folder folder;
    fs::create_directories(folder / "slices");
    std::ofstream(folder / "slices/1.png") << "a slice";
    expectRefusal(folder, {"mesh", (folder / "slices").string(), "--iso", "0", "--format", "ply", "-o",
                           (folder / "slices/1.png").string()});
}

TEST(ReplacingTheInput, IsRefusedForTheVoxelsBesideAHeader) {
    const Folder folder;
    const auto put = [&](const char* name, const std::string& text) {
        std::ofstream(folder / name) << text;
        return (folder / name).string();
    };
    const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 2\nencoding: raw\ndata file: ";
    const std::string meta =
        "ObjectType = Image\nNDims = 3\nDimSize = 4 4 2\nElementType = MET_UCHAR\n"
        "ElementDataFile = ";
    for (const char* voxels : {"a.vdb", "b1.vdb", "b2.vdb"}) put(voxels, std::string(16, 'v'));
    const std::vector<std::pair<std::string, std::vector<const char*>>> headers{
        {put("one.nhdr", nrrd + "a.vdb\n"), {"a.vdb"}},
        {put("list.nhdr", nrrd + "LIST\nb1.vdb\nb2.vdb\n"), {"b2.vdb"}},
        {put("pattern.nhdr", nrrd + "b%d.vdb 1 2 1\n"), {"b2.vdb"}},
        {put("one.mhd", meta + "./a.vdb\n"), {"a.vdb"}},
        {put("list.mhd", meta + "LIST\nb1.vdb\nb2.vdb\n"), {"b1.vdb", "b2.vdb"}},
        {put("pattern.mhd", meta + "b%01d.vdb 1 2 1\n"), {"b1.vdb"}}};
    for (const auto& [header, places] : headers)
        for (const char* place : places)
            expectRefusal(folder, {"analyse", header, "--iso", "0", "-o", (folder / place).string()});
}

TEST(OnePlace, IsNotForTwoResults) {
    const Folder folder;
    writeNrrd(folder / "a.nrrd", {16, 16, 16}, greyBall({16, 16, 16}, 5));
    fs::create_directories(folder / "there");
    fs::create_symlink("there/there_L0.ply", folder / "link.json");
    const auto path = [&](const char* name) { return (folder / name).string(); };
    const auto lod = [&](const char* out, const char* json) {
        return Arguments{"lod", path("a.nrrd"), "--iso", "0", "-o", path(out), "--json", path(json)};
    };
    const auto before = folder.snapshot();
    for (const Arguments& arguments :
         {lod("out", "out"), lod("out", "there/../out"), lod("there", "there/there_L0.ply"),
          lod("there", "there/report.json"), lod("there", "link.json"),
          Arguments{"curves", path("a.nrrd"), "-o", path("out"), "--sheet", path("x"), "--json", path("x")},
          Arguments{"reverse", path("a.obj"), "-o", path("b.obj"), "--details", path("there/../b.obj")},
          Arguments{"reverse", path("a.obj"), "-o", path("b.obj"), "--details", path("d"), "--json",
                    path("d")},
          Arguments{"curve-levels", ISOWAVE_TEST_DATA "/coast/iceland.txt", "-o", path("there"), "--json",
                    path("there/level_0.txt")}}) {
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, 2) << arguments.back() << ": " << result.err;
        EXPECT_NE(result.err.find("would get two results"), std::string::npos) << result.err;
        EXPECT_EQ(folder.snapshot(), before) << arguments.back();
    }
    succeed({"lod", path("a.nrrd"), "--iso", "0", "-o", path("there"), "--json", path("there/other.json")});
}

// Whoever forgets that --json takes a name would lose a mesh otherwise.
TEST(Json, NeverTakesThePlaceOfWhatIsNoReport) {
    const Folder folder;
    const std::string mesh = ISOWAVE_TEST_DATA "/meshes/pinion.off";
    for (const char* name : {"a.off", "b.off", "c.json"}) fs::copy_file(mesh, folder / name);
    const auto before = folder.snapshot();
    const auto path = [&](const char* name) { return (folder / name).string(); };
    for (const Arguments& arguments : {Arguments{"check", "--json", path("a.off"), path("b.off")},
                                       Arguments{"info", path("a.off"), "--json", path("c.json")},
                                       Arguments{"check", path("a.off"), "--json", "--quiet"}}) {
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, 2) << result.err;
        EXPECT_NE(result.err.find("--json: "), std::string::npos) << result.err;
        EXPECT_EQ(folder.snapshot(), before);
    }
    for (int run = 0; run < 2; ++run)  // a report gives way to a report
        succeed({"check", path("a.off"), "--json", path("report.json")});
}

TEST(Rebuild, NeverReplacesItsDetailsByAReport) {
    const Folder folder;
    const auto path = [&](const char* name) { return (folder / name).string(); };
    std::ofstream(folder / "d") << "{\"version\"";
    for (const char* option : {"--details", "--edited"}) {
        const Result result = isowave(
            {"rebuild", path("base.obj"), option, path("d"), "-o", path("again.obj"), "--json", path("d")});
        EXPECT_EQ(result.exitCode, 2) << result.err;
        EXPECT_NE(result.err.find("is what this command reads"), std::string::npos) << result.err;
    }
}

// A file for JSON that cannot be written is found before there are other results.
TEST(Json, ThatCannotBeWrittenLeavesNothingElseBehind) {
    const Folder folder;
    std::ofstream(folder / "file") << "in the way";
    const auto before = folder.snapshot();
    const Result result =
        isowave({"curve-levels", ISOWAVE_TEST_DATA "/coast/iceland.txt", "-o", (folder / "out").string(),
                 "--json", (folder / "file/report.json").string()});
    EXPECT_EQ(result.exitCode, 1) << result.err;
    EXPECT_EQ(result.errorLines(), 1) << result.err;
    EXPECT_EQ(folder.snapshot(), before);
}

}  // namespace
}  // namespace isowave::tools_test
