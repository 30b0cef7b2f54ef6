// analyse, mesh, field, info: a pyramid gives back what lod shows.
#include <openvdb/openvdb.h>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class TorusPyramid : public ::testing::Test {
  protected:
    TorusPyramid() {
        writeStl(folder / "torus.stl", torus(20, 8));
        succeed({"analyse", (folder / "torus.stl").string(), "--voxels", "40", "-o", pyramid()});
    }
    std::string pyramid() const { return (folder / "torus.pyramid.vdb").string(); }

    Folder folder;
};

TEST_F(TorusPyramid, IsAnInputOfLodLikeTheSolidItself) {
    for (const std::string hold : {"none", "local"}) {
        succeed({"lod", (folder / "torus.stl").string(), "--voxels", "40", "--hold", hold, "-o",
                 (folder / ("direct" + hold)).string()});
        succeed({"lod", pyramid(), "--hold", hold, "-o", (folder / ("again" + hold)).string()});
        const Json direct = jsonFile(folder / ("direct" + hold) / "report.json"),
                   again = jsonFile(folder / ("again" + hold) / "report.json");
        EXPECT_EQ(again["input"]["kind"], "pyramid");
        EXPECT_EQ(again["input"]["source"]["path"], direct["input"]["path"]);
        for (const char* key : {"fit", "steps", "coefficients_stored", "control_points"})
            EXPECT_EQ(again[key], direct[key]) << key;
        ASSERT_EQ(again["levels"].size(), direct["levels"].size());
        for (std::size_t i = 0; i < direct["levels"].size(); ++i) {
            const Json &expected = direct["levels"][i], &found = again["levels"][i];
            for (const char* key : {"step", "level", "spacing", "control_points", "nodes", "genus"})
                EXPECT_EQ(found[key], expected[key]) << hold << i << key;
            // What holds thin places is an iteration, which makes more of the last bits of a field that is put together
            // again. Seen: 30 and 32 triangles at level 4.
            EXPECT_NEAR(found["triangles"].get<double>(), expected["triangles"].get<double>(),
                        hold == "none" ? 0 : 8)
                << hold << i;
        }
    }
}

TEST_F(TorusPyramid, IsTheSameFileForEveryNumberOfThreads) {
    for (const std::string threads : {"1", "2", "4"}) {
        const fs::path file = folder / (threads + ".vdb");
        succeed({"analyse", (folder / "torus.stl").string(), "--voxels", "40", "--threads", threads, "-o",
                 file.string()});
        EXPECT_EQ(contentOf(file), contentOf(pyramid())) << threads;
    }
}

TEST_F(TorusPyramid, WritesMeshesByTheNameOfTheFile) {
    const std::map<std::string, std::string> starts{
        {"a.ply", "ply"}, {"a.off", "OFF"}, {"a.obj", "#"}, {"a.glb", "glTF"}, {"a.STL", ""}};
    for (const auto& [name, start] : starts) {
        succeed({"mesh", pyramid(), "--level", "1", "-o", (folder / name).string()});
        EXPECT_EQ(contentOf(folder / name).substr(0, start.size()), start) << name;
    }
    succeed({"mesh", pyramid(), "--level", "1", "--format", "off", "-o", (folder / "plain").string()});
    EXPECT_EQ(contentOf(folder / "plain"), contentOf(folder / "a.off"));
    succeed({"mesh", pyramid(), "--step", "3", "-o", (folder / "b.off").string()});
    EXPECT_EQ(contentOf(folder / "b.off"), contentOf(folder / "a.off")) << "level 1 is step 3";
}

TEST_F(TorusPyramid, SaysWhichStepToTakeInsteadOfOneThatItDoesNotHave) {
    const auto refused = [&](const char* option, const std::string& number) {
        const Result result =
            isowave({"mesh", pyramid(), option, number, "-o", (folder / "x.ply").string(), "--quiet"});
        EXPECT_EQ(result.exitCode, 3) << number;
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_FALSE(fs::exists(folder / "x.ply"));
        return result.err;
    };
    EXPECT_THAT(refused("--level", "20"), HasSubstr("not step 60 (level 20)"));
    EXPECT_THAT(refused("--step", "61"), HasSubstr("not step 61\n"));
    const auto steps = succeed({"info", pyramid(), "--json", "-"}).json()["steps"];
    const std::string last = std::to_string(steps.size() - 1);
    const std::string text = refused("--step", last);
    ASSERT_THAT(text, HasSubstr("the whole solid has vanished at step " + last + "; take step "));
    const std::string instead = std::to_string(std::stoi(text.substr(text.rfind("; take step ") + 12)));
    succeed({"mesh", pyramid(), "--step", instead, "-o", (folder / "x.ply").string()});
}

TEST_F(TorusPyramid, GivesItsFieldAsAGridForOtherTools) {
    succeed({"field", pyramid(), "--step", "0", "-o", (folder / "field.vdb").string()});
    openvdb::initialize();
    openvdb::io::File file((folder / "field.vdb").string());
    file.open();
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("field"));
    ASSERT_TRUE(grid);
    const Json info = succeed({"info", pyramid(), "--json", "-"}).json();
    EXPECT_EQ(grid->activeVoxelCount(), info["control_points"].get<std::uint64_t>());
    const auto centreOfTube = grid->transform().worldToIndex({20, 0, 0});
    EXPECT_LT(grid->tree().getValue(openvdb::Coord::round(centreOfTube)), 0) << "negative inside";
    EXPECT_GT(grid->tree().getValue(openvdb::Coord::round(grid->transform().worldToIndex({0, 0, 0}))), 0);
}

TEST_F(TorusPyramid, GivesTheFieldOfALevelThatIsHeld) {
    // The ring's tube is thin at level 3.
    const auto controlPoints = [&](const char* hold) {
        const std::filesystem::path file = folder / (std::string(hold) + ".vdb");
        succeed({"field", pyramid(), "--level", "3", "--hold", hold, "-o", file.string()});
        openvdb::initialize();
        openvdb::io::File vdb(file.string());
        vdb.open();
        return openvdb::gridPtrCast<openvdb::FloatGrid>(vdb.readGrid("field"));
    };
    const auto plain = controlPoints("none"), held = controlPoints("local");
    int changed = 0;
    for (auto c = held->cbeginValueOn(); c; ++c) changed += *c != plain->tree().getValue(c.getCoord());
    EXPECT_GT(changed, 0);
}

TEST_F(TorusPyramid, IsListedStepByStep) {
    const Result text = succeed({"info", pyramid()});
    EXPECT_NE(text.out.find("coefficients stored for"), std::string::npos);
    EXPECT_NE(text.out.find("bytes a control point"), std::string::npos);
    const Json info = succeed({"info", pyramid(), "--json", "-"}).json();
    EXPECT_EQ(info["kind"], "pyramid");
    EXPECT_EQ(info["format_version"], 1);
    const Json& steps = info["steps"];
    EXPECT_EQ(steps[0]["control_points"], info["control_points"]);
    EXPECT_EQ(steps[0]["coefficients"], info["coefficients_stored"]);
    EXPECT_EQ(info["file_bytes"], std::filesystem::file_size(pyramid()));
    EXPECT_GT(info["memory_bytes"].get<double>(), 4 * info["coefficients_stored"].get<double>());
    for (const Json& step : steps) {
        EXPECT_GT(step["leaf_occupancy"].get<double>(), 0);
        EXPECT_LE(step["leaf_occupancy"].get<double>(), 1);
    }
    for (std::size_t s = 0; s + 1 < steps.size(); ++s) {
        EXPECT_EQ(steps[s]["step"], s);
        EXPECT_EQ(steps[s]["details"].get<std::int64_t>() + steps[s + 1]["coefficients"].get<std::int64_t>(),
                  steps[s]["coefficients"].get<std::int64_t>());
        // One axis is halved at a time.
        double ratio = 1;
        for (int axis = 0; axis < 3; ++axis)
            ratio *= steps[s + 1]["spacing"][axis].get<double>() / steps[s]["spacing"][axis].get<double>();
        EXPECT_DOUBLE_EQ(ratio, 2);
    }
    EXPECT_EQ(steps.back()["coefficients"], steps.back()["control_points"]);
    EXPECT_EQ(steps.back()["control_points"], 64) << "one node";
    EXPECT_EQ(steps.back()["nodes"], 1);
}

// ---- info of other files ----

openvdb::FloatGrid::Ptr ballLevelSet(double radius) {
    openvdb::initialize();
    auto grid = openvdb::FloatGrid::create(3.0f);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName("ball");
    const int reach = static_cast<int>(radius) + 6;
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = -reach; z <= reach; ++z) {
                const double d = std::sqrt(double(x * x + y * y + z * z)) - radius;
                if (std::abs(d) < 3)
                    grid->tree().setValueOn({x, y, z}, static_cast<float>(d));
                else if (d < 0)
                    grid->tree().setValueOff({x, y, z}, -3.0f);
            }
    return grid;
}

TEST(Info, DescribesAnImage) {
    const Folder folder;
    const Size size{24, 20, 16};
    writeNrrd(folder / "a.nrrd", size, greyBall(size, 5),
              "space: left-posterior-superior\nspace directions: (0,2,0) (-1,0,0) (0,0,3)\nspace origin: "
              "(5,6,7)\n");
    const Json info = succeed({"info", (folder / "a.nrrd").string(), "--json", "-"}).json();
    EXPECT_EQ(info["kind"], "image");
    EXPECT_EQ(info["component_type"], "int16");
    EXPECT_EQ(info["dimensions"], Json({24, 20, 16}));
    EXPECT_EQ(info["spacing"], Json({2.0, 1.0, 3.0}));
    EXPECT_EQ(info["origin"], Json({5.0, 6.0, 7.0}));
    EXPECT_EQ(info["direction"], Json({{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}));
    EXPECT_EQ(info["range"], Json({-100.0, 100.0}));
    EXPECT_EQ(info["percentiles"]["50"], -100.0);
    EXPECT_NE(succeed({"info", (folder / "a.nrrd").string()}).out.find("24 x 20 x 16"), std::string::npos);
}

TEST(Info, DescribesAMesh) {
    const Folder folder;
    writeStl(folder / "torus.stl", torus(20, 8));
    const Json info = succeed({"info", (folder / "torus.stl").string(), "--json", "-"}).json();
    EXPECT_EQ(info["kind"], "mesh");
    EXPECT_EQ(info["triangles"], 2 * 48 * 24);
    EXPECT_EQ(info["vertices"], 48 * 24);
    EXPECT_EQ(info["genus"], 1);
    EXPECT_DOUBLE_EQ(info["bounds"][1][0].get<double>(), 28);
    EXPECT_DOUBLE_EQ(info["bounds"][0][2].get<double>(), -8);
}

TEST(Info, ListsTheGridsOfAVdb) {
    const Folder folder;
    openvdb::io::File((folder / "ball.vdb").string()).write({ballLevelSet(6)});
    const Json info = succeed({"info", (folder / "ball.vdb").string(), "--json", "-"}).json();
    EXPECT_EQ(info["kind"], "vdb");
    ASSERT_EQ(info["grids"].size(), 1u);
    EXPECT_EQ(info["grids"][0]["name"], "ball");
    EXPECT_EQ(info["grids"][0]["type"], "float");
    EXPECT_EQ(info["grids"][0]["class"], "level set");
}

}  // namespace
}  // namespace isowave::tools_test
