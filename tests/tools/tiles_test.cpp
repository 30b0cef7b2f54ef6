// isowave lod --tiles: a folder beside the meshes, all at once with them. What is in it: tests/io/mesh/tiles_test.cpp.
#include "tests/tools/refusal.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

std::string partFile() { return std::string(ISOWAVE_TEST_DATA) + "/meshes/gearwheel.bin.stl"; }

TEST(TilesOption, PutsAFolderBesideTheMeshesThatTheReportNames) {
    const Folder folder;
    const std::string part = (folder / "part").string();
    succeed({"lod", partFile(), "--voxels", "32", "--levels", "0..2", "--tiles", "neuroglancer", "-o", part});
    EXPECT_EQ(jsonFile(folder / "part/report.json")["tiles"], "part_neuroglancer");
    EXPECT_TRUE(fs::is_regular_file(folder / "part/part_neuroglancer/info"));
    EXPECT_TRUE(fs::is_regular_file(folder / "part/part_neuroglancer/1.index"));
    EXPECT_TRUE(fs::is_regular_file(folder / "part/part_L2.ply"));
    succeed({"lod", partFile(), "--voxels", "32", "--levels", "1..2", "--tiles", "3d-tiles", "-o", part});
    const auto tileset = jsonFile(folder / "part/part_3d-tiles/tileset.json");
    EXPECT_GT(tileset["root"]["geometricError"].get<double>(), 0);
    EXPECT_TRUE(fs::is_regular_file(folder / "part/part_neuroglancer/info"));  // of the run before
}

TEST(TilesOption, SameBytesForAnyNumberOfThreads) {
    const Folder folder;
    for (const char* format : {"neuroglancer", "3d-tiles"}) {
        for (const char* threads : {"1", "3"})
            succeed({"lod", partFile(), "--voxels", "48", "--levels", "0..1", "--tiles", format, "--threads",
                     threads, "-o", (folder / (std::string("t") + threads) / "part").string()});
        const std::string tiles = std::string("part/part_") + format;
        std::size_t files = 0;
        for (const auto& entry : fs::recursive_directory_iterator(folder / "t1" / tiles)) {
            if (!entry.is_regular_file()) continue;
            ++files;
            EXPECT_EQ(contentOf(entry.path()),
                      contentOf(folder / "t3" / entry.path().lexically_relative(folder / "t1")));
        }
        EXPECT_GE(files, 3u);
    }
}

TEST(TilesOption, ReplacesTilesAsAWholeAndNothingElse) {
    const Folder folder;
    const std::string part = (folder / "part").string();
    const std::vector<std::string> words = {"lod",  partFile(), "--voxels", "24", "--levels",
                                            "0..1", "--tiles",  "3d-tiles", "-o", part};
    succeed(words);
    std::ofstream(folder / "part/part_3d-tiles/L0/stale.glb") << "x";
    succeed(words);
    EXPECT_FALSE(fs::exists(folder / "part/part_3d-tiles/L0/stale.glb"));
    fs::remove_all(folder / "part/part_3d-tiles");
    fs::create_directory(folder / "part/part_3d-tiles");
    std::ofstream(folder / "part/part_3d-tiles/letters.txt") << "mine";
    expectRefused(folder, words, 1, "move it away");
}

TEST(TilesOption, NeedsLevels) {
    const Folder folder;
    const std::string part = (folder / "part").string();
    expectRefused(folder, {"lod", partFile(), "--steps", "0..3", "--tiles", "3d-tiles", "-o", part}, 2,
                  "give --levels");
    expectRefused(folder, {"lod", partFile(), "--triangles", "500", "--tiles", "3d-tiles", "-o", part}, 2,
                  "give --levels too");
    expectRefused(folder, {"lod", partFile(), "--tiles", "cesium", "-o", part}, 2, "neuroglancer, 3d-tiles");
}

}  // namespace
}  // namespace isowave::tools_test
