// What lod, mesh and info do to a level's mesh and say about it: the iso-value, specks, topology, features.
#include <cmath>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"
#include "tests/zoo/zoo.h"

namespace isowave::tools_test {
namespace {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

// A grey image of a signed distance, 20 HU a voxel, of spacing 0.5 mm.
template <class Distance>
void writeDistance(const fs::path& file, Size size, const Distance& distance) {
    writeNrrd(
        file, size,
        sampled<std::int16_t>(size,
                              [&](int x, int y, int z) {
                                  return std::lround(std::clamp(-20.0 * distance(x, y, z), -200.0, 200.0));
                              }),
        "spacings: 0.5 0.5 0.5\n");
}

// A box 40 x 40 x 14 with four holes of radius 1.5, 2.5, 4 and 6 voxels through it, and a grain of radius 1.7 beside it.
double plate(double x, double y, double z) {
    const double radius[] = {1.5, 2.5, 4, 6};
    double d = std::max({std::abs(x - 27.3) - 22.2, std::abs(y - 27.4) - 22.1, std::abs(z - 12.2) - 5.1});
    for (int i = 0; i < 4; ++i)
        d = std::max(d, radius[i] - std::hypot(x - 16.6 - 21.7 * (i % 2), y - 16.1 - 22.3 * (i / 2)));
    return std::min(d, std::hypot(x - 27, y - 27, z - 24.1) - 1.7);
}

// A wall 2 voxels thick, in a frame that is 8 thick.
double framedWall(double x, double y, double z) {
    const double a = std::max(std::abs(x - 30.2), std::abs(y - 29.7)), h = std::abs(z + 0.15 * x - 20.3);
    return std::min(std::max(h - 1, a - 22), std::max({h - 4, a - 22, 16 - a}));
}

class Levels : public ::testing::Test {
  protected:
    Levels() {
        writeDistance(folder / "plate.nrrd", {56, 56, 30}, plate);
        writeDistance(folder / "wall.nrrd", {62, 62, 36}, framedWall);
    }
    Json lod(const std::string& name, const Arguments& more, Result* result = nullptr) {
        Arguments arguments{
            "lod", (folder / (name + ".nrrd")).string(), "--iso", "0", "-o", (folder / "out").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result r = succeed(arguments);
        if (result) *result = r;
        return jsonFile(folder / "out/report.json")["levels"];
    }
    Folder folder;
};

TEST_F(Levels, KeepTheVolumeOfLevel0) {
    Result result;
    const Json levels = lod("plate", {"--levels", "0..3", "--preserve-volume"}, &result);
    ASSERT_GE(levels.size(), 3u);
    const double volume = levels[0]["volume"].get<double>();
    EXPECT_EQ(levels[0]["iso_shift"], 0.0);
    EXPECT_EQ(levels[0]["volume_error"], 0.0);
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const Json& level = levels[i];
        EXPECT_LT(std::abs(level["volume_error"].get<double>()), 1e-4) << i;
        EXPECT_NEAR(level["volume"].get<double>(), volume, 1.0001e-4 * volume) << i;
        EXPECT_NE(level["iso_shift"], 0.0) << i;
        EXPECT_LT(std::abs(level["iso_shift"].get<double>()), 0.75) << i;
        // The distance is what the volume grew by, over the area.
        const double grown = level["volume"].get<double>() - level["volume_at_iso_0"].get<double>();
        EXPECT_NEAR(level["iso_distance"].get<double>(), grown / level["area"].get<double>(),
                    0.3 * std::abs(level["iso_distance"].get<double>()))
            << i;
        EXPECT_EQ(level["closed"], true);
        EXPECT_EQ(level["manifold"], true);
    }
    EXPECT_NE(result.out.find("moves the surface by"), std::string::npos) << result.out;
    const Json free = lod("plate", {"--levels", "0..2"});
    EXPECT_EQ(free[1]["iso_shift"], 0.0);
    EXPECT_EQ(free[1]["volume"], levels[1]["volume_at_iso_0"]);
}

TEST_F(Levels, SayWhereTheVolumeIsOutOfReach) {
    writeDistance(folder / "ball.nrrd", {24, 24, 24},
                  [](int x, int y, int z) { return std::hypot(x - 11.6, y - 11.4, z - 11.8) - 1.2; });
    Result result;
    const Json levels = lod("ball", {"--preserve-volume"}, &result);
    bool missed = false;
    for (const Json& level : levels)
        if (!level["volume_error"].is_null() && std::abs(level["volume_error"].get<double>()) > 1e-4)
            missed = true;
    EXPECT_EQ(missed, result.err.find("the volume of level 0 is out of reach") != std::string::npos)
        << result.err;
    EXPECT_TRUE(missed);
}

TEST_F(Levels, KeepThinWallsWhenAsked) {
    const Json torn = lod("wall", {"--levels", "0..2"}),
               kept = lod("wall", {"--levels", "0..2", "--protect-thin"});
    EXPECT_EQ(torn[0]["genus"], 0);
    EXPECT_GT(torn[2]["genus"], 0) << "the wall is torn or gone";
    EXPECT_LT(torn[2]["thin_kept"], 0.9);
    EXPECT_EQ(torn[2]["thin_kept"], torn[2]["thin_kept_at_iso_0"]);
    for (int i = 1; i <= 2; ++i) {
        EXPECT_GE(kept[i]["thin_kept"], 0.95) << i;
        EXPECT_LE(kept[i]["genus"], 1) << i;
        EXPECT_EQ(kept[i]["parts"], 1) << i;
        EXPECT_GE(kept[i]["iso_shift"], 0.0) << i;
        EXPECT_EQ(kept[i]["thin_kept_at_iso_0"], torn[i]["thin_kept"]) << i;
    }
    EXPECT_GT(kept[2]["iso_distance"], 0.0);
    EXPECT_LT(kept[2]["iso_distance"], 0.5 * kept[2]["spacing"][0].get<double>());
}

TEST_F(Levels, AreTheSameFromMeshAsFromLod) {
    for (const std::string option : {"--preserve-volume", "--protect-thin", "--keep-specks"}) {
        lod("wall", {"--levels", "0..2", option});
        succeed({"mesh", (folder / "wall.nrrd").string(), "--iso", "0", "--level", "2", option, "-o",
                 (folder / "one.ply").string()});
        EXPECT_EQ(contentOf(folder / "one.ply"), contentOf(folder / "out/out_L2.ply")) << option;
    }
}

TEST_F(Levels, RefuseTwoReasonsForOneIsoValue) {
    const std::string in = (folder / "wall.nrrd").string(), out = (folder / "o").string();
    for (const Arguments& more : {Arguments{"--preserve-volume", "--protect-thin"},
                                  Arguments{"--preserve-volume", "--open-border"}}) {
        Arguments arguments{"lod", in, "--iso", "0", "-o", out};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, 2);
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_NE(result.err.find("--preserve-volume"), std::string::npos);
        EXPECT_FALSE(fs::exists(out));
    }
}

TEST_F(Levels, LoseSpecksUnlessTheyAreToBeKept) {
    const Json clean = lod("plate", {"--steps", "0..4"}),
               all = lod("plate", {"--steps", "0..4", "--keep-specks"});
    EXPECT_EQ(clean[0]["parts"], 2) << "a grain of the input is data";
    EXPECT_EQ(clean[0]["specks_removed"], 0);
    bool removed = false;
    for (std::size_t i = 0; i < clean.size(); ++i) {
        const Json &c = clean[i], &a = all[i];
        EXPECT_EQ(a["specks_removed"], 0);
        EXPECT_EQ(a["parts"].get<int>(), c["parts"].get<int>() + c["specks_removed"].get<int>()) << i;
        EXPECT_EQ(a["cavities"].get<int>(), c["cavities"].get<int>() + c["bubbles_removed"].get<int>()) << i;
        EXPECT_NEAR(
            a["volume"].get<double>(),
            c["volume"].get<double>() + c["speck_volume"].get<double>() - c["bubble_volume"].get<double>(),
            1e-9);
        const Json& h = c["spacing"];
        if (c["specks_removed"] > 0) {
            EXPECT_LT(c["speck_volume"].get<double>() / c["specks_removed"].get<double>(),
                      h[0].get<double>() * h[1].get<double>() * h[2].get<double>());
            removed = true;
        }
        EXPECT_EQ(c["closed"], true);
        EXPECT_EQ(c["manifold"], true);
    }
    EXPECT_TRUE(removed) << "the grain becomes smaller than a node at some step";
}

TEST_F(Levels, TellWhatBecameOfHolesAndParts) {
    Result result;
    const Json levels = lod("plate", {"--levels", "0..3", "--features"}, &result);
    const Json& f0 = levels[0]["features"];
    EXPECT_EQ(f0["handles"]["survived"], 4);
    EXPECT_EQ(f0["parts"]["survived"], 2);
    EXPECT_NEAR(f0["handles"]["smallest_surviving"].get<double>(), 0.5 * 1.5, 0.4);
    EXPECT_EQ(f0["handles"]["largest_vanished"], nullptr);
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const Json &level = levels[i], &holes = level["features"]["handles"];
        EXPECT_EQ(holes["survived"].get<int>() + holes["vanished"].get<int>() + holes["torn"].get<int>(), 4)
            << i;
        EXPECT_EQ(level["change"]["handles"].get<int>(),
                  level["genus"].get<int>() - levels[i - 1]["genus"].get<int>());
        EXPECT_EQ(level["change"]["parts"].get<int>(),
                  level["parts"].get<int>() - levels[i - 1]["parts"].get<int>());
        // Components and handles never rise by more than what is explained.
        for (const char* kind : {"parts", "handles"}) {
            const int now = level[kind == std::string("parts") ? "parts" : "genus"].get<int>();
            EXPECT_LE(now, level["features"][kind]["survived"].get<int>() +
                               level["features"][kind]["more"].get<int>());
            if (i <= 2) {
                EXPECT_EQ(level["features"][kind]["more"], 0) << i << kind;
            }
        }
    }
    EXPECT_NE(result.out.find("level 2 (2 mm): "), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("holes closed up to radius"), std::string::npos) << result.out;
    EXPECT_EQ(lod("plate", {"--levels", "0..1"})[1]["features"], nullptr);
}

// The rule of docs/topology.md: of what a level has beyond the level before, a finer lattice does not find what the
// mesh's sampling adds; what is left is torn, so that something thin is lost. Returns how many were explained.
int explainedBySampling(const Json& levels, const std::string& what) {
    const std::pair<const char*, const char*> kinds[] = {
        {"parts", "parts"}, {"genus", "handles"}, {"cavities", "cavities"}};
    int explained = 0;
    for (const Json& level : levels) {
        const Json &s = level["sampling"], &change = level["change"];
        const bool more = change["parts"] > 0 || change["handles"] > 0 || change["cavities"] > 0;
        EXPECT_EQ(s.is_null(), !more) << what << level["step"];
        if (s.is_null()) continue;
        EXPECT_GT(s["refine"], level["refine"]);
        for (const auto& [key, kind] : kinds) {
            const int now = level[key], before = now - change[kind].get<int>(), finer = s[key];
            if (now <= before) continue;
            explained += std::clamp(now - finer, 0, now - before);
            if (finer > before) {
                EXPECT_LT(s["thin_kept"], 1.0) << what << level["step"] << ": " << finer - before << " new "
                                               << kind << " of unknown origin";
            }
        }
    }
    return explained;
}

TEST_F(Levels, OfRealSolidsRiseOnlyBySamplingAndTearing) {
    const fs::path data = fs::path(ISOWAVE_TEST_DATA);
    const auto explained = [&](const std::string& file, const Arguments& more) {
        Arguments arguments{"lod", (data / file).string(), "-o", (folder / "real").string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        succeed(arguments);
        return explainedBySampling(jsonFile(folder / "real/report.json")["levels"], file + " ");
    };
    EXPECT_GT(explained("ct/cranium_crop.nrrd", {"--iso", "300"}), 0);  // seen: a part of level 3
    EXPECT_GT(explained("meshes/pinion.off", {"--voxels", "64"}), 0);   // seen: 4 handles of levels 2 and 3
    EXPECT_GT(explained("meshes/gearwheel.bin.stl", {"--voxels", "64", "--steps", "0..9"}), 0);
    EXPECT_GT(explained("meshes/bones.off", {"--voxels", "64", "--steps", "0..9"}), 0);
}

// A solid of the zoo as a mask of -1 and 1, 4 voxels of background around it.
void writeMask(const fs::path& file, const zoo::Solid& solid) {
    const openvdb::Coord low = solid.box.min().offsetBy(-4), dim = solid.box.dim().offsetBy(8);
    const Size size{dim.x(), dim.y(), dim.z()};
    writeNrrd(file, size, sampled<std::int16_t>(size, [&](int x, int y, int z) {
                  const openvdb::Coord c = low.offsetBy(x, y, z);
                  return solid.box.isInside(c) && solid.inside(c) ? 1 : -1;
              }));
}

TEST_F(Levels, OfTheZooRiseOnlyBySamplingAndTearing) {
    int explained = 0, solids = 0;
    for (const auto& group :
         {zoo::smoothSolids(), zoo::cadSolids(), zoo::thinSolids(), zoo::noisySolids(), zoo::borderSolids()})
        for (const zoo::Solid& solid : group) {
            writeMask(folder / "zoo.nrrd", solid);
            explained += explainedBySampling(lod("zoo", {}), solid.name + " ");
            ++solids;
        }
    EXPECT_GE(solids, 12);
    EXPECT_GT(explained, 0);
}

TEST_F(Levels, SayHowMuchOfARiseIsSampling) {
    Result result;
    const Json levels = lod("wall", {"--levels", "0..1"}, &result);
    EXPECT_EQ(levels[0]["sampling"], nullptr);
    EXPECT_EQ(lod("plate", {"--levels", "0..1"})[1]["sampling"], nullptr) << "nothing rises";
    // A second run at that refinement has the same counts.
    const std::string pinion = std::string(ISOWAVE_TEST_DATA) + "/meshes/pinion.off",
                      out = (folder / "p").string();
    result = succeed({"lod", pinion, "--voxels", "64", "--levels", "2", "-o", out});
    const Json level = jsonFile(folder / "p/report.json")["levels"][0], s = level["sampling"];
    EXPECT_EQ(level["change"]["handles"], 1);
    EXPECT_EQ(level["refine"], 1);
    EXPECT_EQ(s["refine"], 2);
    EXPECT_NE(result.out.find("1 of 1 new handle is the mesh's sampling, --refine 2 has 1"),
              std::string::npos)
        << result.out;
    succeed(
        {"lod", pinion, "--voxels", "64", "--levels", "2", "--refine", "2", "-o", (folder / "q").string()});
    const Json fine = jsonFile(folder / "q/report.json")["levels"][0];
    for (const char* key : {"parts", "genus", "cavities", "refine"}) EXPECT_EQ(s[key], fine[key]) << key;
    EXPECT_EQ(fine["sampling"], nullptr);
}

TEST_F(Levels, AreSampledFinerWhereTheMeshPerforatesThinWalls) {
    const std::string pinion = std::string(ISOWAVE_TEST_DATA) + "/meshes/pinion.off";
    succeed({"lod", pinion, "--voxels", "64", "--levels", "0..2", "--protect-thin", "-o",
             (folder / "p").string()});
    const Json levels = jsonFile(folder / "p/report.json")["levels"];
    const int refine[] = {1, 1, 2};
    for (int i = 0; i <= 2; ++i) {
        EXPECT_EQ(levels[i]["refine"], refine[i]) << i;
        EXPECT_EQ(levels[i]["genus"], 1) << i;
    }
    succeed({"mesh", pinion, "--voxels", "64", "--level", "2", "--protect-thin", "-o",
             (folder / "p.ply").string()});
    EXPECT_EQ(contentOf(folder / "p.ply"), contentOf(folder / "p/p_L2.ply"));
}

TEST_F(Levels, OfAPyramidAreToldByInfo) {
    const std::string pyramid = (folder / "plate.pyramid.vdb").string();
    succeed({"analyse", (folder / "plate.nrrd").string(), "--iso", "0", "-o", pyramid});
    const Json levels = lod("plate", {});
    const Json info = succeed({"info", pyramid, "--json"}).json()["levels"];
    ASSERT_GE(info.size(), 3u);
    for (std::size_t i = 0; i < info.size(); ++i)
        for (const char* key :
             {"level", "spacing", "parts", "genus", "cavities", "change", "triangles", "specks_removed"})
            EXPECT_EQ(info[i][key], levels[i][key]) << i << " " << key;
    const std::string text = succeed({"info", pyramid}).out;
    EXPECT_NE(text.find("level 0 (0.5 mm): 4 handles, 2 parts"), std::string::npos) << text;
    EXPECT_NE(text.find("level 1 (1 mm): "), std::string::npos) << text;
    const std::string more = succeed({"info", pyramid, "--features"}).out;
    EXPECT_NE(more.find("open from radius"), std::string::npos) << more;
}

}  // namespace
}  // namespace isowave::tools_test
