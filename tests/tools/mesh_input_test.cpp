// Meshes as people have them, through the program: what is not kept is said, units, open sheets, GLB in and out.
#include <gmock/gmock.h>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Arguments = std::vector<std::string>;
using Json = nlohmann::json;

// A box of 10 x 10 x 10 at x, of 12 triangles, with colours, texture coordinates, materials and groups, and a point in no face.
std::string boxObj(double x = 0, bool lid = true) {
    std::string text = "mtllib a.mtl\no box\nvt 0 0\n";
    for (int i = 0; i < 8; ++i)
        text += "v " + std::to_string(x + (i & 1 ? 10 : 0)) + (i & 2 ? " 10" : " 0") +
                (i & 4 ? " 10" : " 0") + " 1 0.5 0\n";
    text += "v 99 99 99\nusemtl red\nf 1 3 4 2\nf 1/1 2/1 6/1 5/1\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    return lid ? text + "f 5 6 8 7\n" : text;
}

void put(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

Arguments lod(const Folder& folder, const std::string& input, Arguments more = {}) {
    Arguments arguments{"lod", (folder / input).string(), "--voxels", "40", "--levels", "0",
                        "-o",  (folder / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

Json checked(const fs::path& mesh) {
    return Json::parse(succeed({"check", mesh.string(), "--json", "-"}).out);
}

TEST(MeshInput, SaysWhatIsNotKept) {
    const Folder folder;
    put(folder / "box.obj", boxObj());
    const std::string words = "colours, texture coordinates, materials and groups are not kept";
    const Result result = succeed(lod(folder, "box.obj"));
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_THAT(jsonFile(folder / "out/report.json")["input"]["repair"].dump(), HasSubstr(words));
    const std::string fine = (folder / "fine.obj").string();
    const Result subdivided = succeed({"subdivide", (folder / "box.obj").string(), "-o", fine});
    EXPECT_THAT(subdivided.err, AllOf(HasSubstr(words), HasSubstr("1 vertex in no face left out")));
    put(folder / "fine2.obj", contentOf(fine) + "g all\nv 9 9 9\n");
    const Result reversed =
        succeed({"reverse", (folder / "fine2.obj").string(), "-o", (folder / "base.obj").string()});
    EXPECT_THAT(reversed.err,
                AllOf(HasSubstr("groups are not kept"), HasSubstr("1 vertex in no face left out")));
}

TEST(MeshInput, UnitsGoIntoGlbAndTheReport) {
    const Folder folder;
    put(folder / "box.obj", boxObj());
    for (const auto& [unit, mm] : {std::pair{"mm", 1.0}, {"m", 1000.0}, {"in", 25.4}}) {
        const Result result = succeed(lod(folder, "box.obj", {"--unit", unit, "--format", "glb"}));
        EXPECT_THAT(result.out, HasSubstr(std::string("[") + unit + "]"));
        EXPECT_EQ(jsonFile(folder / "out/report.json")["input"]["unit"], unit);
        EXPECT_NEAR(checked(folder / "out/out_L0.glb")["volume"].get<double>(), 1000 * mm * mm * mm,
                    10 * mm * mm * mm);
    }
    // Coordinates stay, and a pyramid remembers.
    succeed({"analyse", (folder / "box.obj").string(), "--voxels", "40", "--unit", "m", "-o",
             (folder / "b.vdb").string()});
    for (const auto& [name, volume] : {std::pair{"b.ply", 1e3}, {"b.glb", 1e12}}) {
        succeed({"mesh", (folder / "b.vdb").string(), "-o", (folder / name).string()});
        EXPECT_NEAR(checked(folder / name)["volume"].get<double>(), volume, 0.01 * volume);
    }
    // GLB comes in in the unit that is asked for, and goes out as it was.
    succeed(lod(folder, "b.glb", {"--unit", "m"}));
    EXPECT_NEAR(checked(folder / "out/out_L0.ply")["volume"].get<double>(), 1000, 10);
    EXPECT_EQ(isowave(lod(folder, "box.obj", {"--unit", "furlong"})).exitCode, 2);
    EXPECT_EQ(isowave(lod(folder, "b.vdb", {"--unit", "m"})).exitCode, 2);
}

TEST(MeshInput, RatiosAreSharesOfTheMesh) {
    const Folder folder;
    writeStl(folder / "ring.stl", torus(20, 8));  // 48 x 24 quads: 2,304 triangles
    succeed(lod(folder, "ring.stl", {"--ratio", "0.5,0.1"}));
    const Json budgets = jsonFile(folder / "out/report.json")["budgets"];
    EXPECT_EQ(budgets[0]["triangles_asked"], 1152);
    EXPECT_EQ(budgets[1]["triangles_asked"], 230);
    for (const Json& budget : budgets) EXPECT_LE(budget["triangles"], budget["triangles_asked"]);
}

TEST(MeshInput, OpenMeshesAreClosedOrThickenedWhenAsked) {
    const Folder folder;
    put(folder / "box.obj", boxObj(0, false));
    const Result refused = isowave(lod(folder, "box.obj"));
    EXPECT_EQ(refused.exitCode, 3);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("--close-holes 10 "), HasSubstr("--thicken")));
    EXPECT_THAT(succeed(lod(folder, "box.obj", {"--close-holes", "10"})).err, HasSubstr("1 hole filled"));
    EXPECT_NEAR(checked(folder / "out/out_L0.ply")["volume"].get<double>(), 1000, 10);
    const Result thick = succeed(lod(folder, "box.obj", {"--thicken", "2"}));
    EXPECT_THAT(thick.err, HasSubstr("thickened: the solid is all within 1 of the"));
    const Json sheet = checked(folder / "out/out_L0.ply");
    EXPECT_EQ(sheet["components"].size(), 1u);
    // Outside: five faces, eight edges and four corners below the rim. Above the rim: half a tube along it, octants at its
    // corners, less what two tubes share within (2/3 each). Within the box: all but 8 x 8 x 9.
    const double pi = 3.14159265358979, octant = pi / 6;
    const double volume =
        500 + 8 * 10 * pi / 4 + 4 * octant + 8 * 10 * pi / 4 + 4 * octant - 4 * 2.0 / 3 + 1000 - 576;
    EXPECT_NEAR(sheet["volume"].get<double>(), volume, 2);  // seen 1050.3 of 1051.2
    EXPECT_THAT(isowave(lod(folder, "box.obj", {"--thicken", "0.3"})).err, HasSubstr("give --voxel"));
    EXPECT_EQ(isowave(lod(folder, "box.obj", {"--thicken", "2", "--close-holes", "10"})).exitCode, 2);
}

TEST(MeshInput, ContradictionsAreRefused) {
    const Folder folder;
    put(folder / "box.obj", boxObj());
    const Result result = isowave(
        {"mesh", (folder / "box.obj").string(), "-o", (folder / "m.obj").string(), "--format", "stl"});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.err, HasSubstr("contradict each other"));
    EXPECT_FALSE(fs::exists(folder / "m.obj"));
    for (const char* command : {"check", "subdivide", "reverse"}) {
        put(folder / "a.step", "ISO-10303-21;");
        Arguments arguments{command, (folder / "a.step").string()};
        if (std::string(command) != "check")
            arguments.insert(arguments.end(), {"-o", (folder / "o.obj").string()});
        const Result step = isowave(arguments);
        EXPECT_EQ(step.exitCode, 3);
        EXPECT_THAT(step.err, HasSubstr("a.step -2 -clcurv 12 -o")) << command;
        EXPECT_EQ(step.errorLines(), 1);
    }
}

}  // namespace
}  // namespace isowave::tools_test
