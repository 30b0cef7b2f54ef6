// isowave lod on small inputs: files, report, talk, determinism. What levels are like is tested in tests/lod.
#include <gmock/gmock.h>

#include <set>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Arguments = std::vector<std::string>;
using Json = nlohmann::json;
using testing::HasSubstr;

const double kPi = std::acos(-1.0);

std::set<std::string> keysOf(const Json& object) {
    std::set<std::string> keys;
    for (const auto& item : object.items()) keys.insert(item.key());
    return keys;
}

std::set<std::string> namesIn(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
    return names;
}

// A ladder made from a ball of radius 9 in a small grey image.
class BallLadder : public ::testing::Test {
  protected:
    static constexpr Size kSize{32, 32, 32};

    BallLadder() { writeNrrd(folder / "ball.nrrd", kSize, greyBall(kSize, 9), "spacings: 0.5 0.5 0.5\n"); }

    Result ladder(Arguments more, const std::string& output = "out/ball") {
        Arguments arguments{"lod", (folder / "ball.nrrd").string(), "--iso", "0",
                            "-o",  (folder / output).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return succeed(arguments);
    }
    Json report(const std::string& output = "out/ball") const {
        return jsonFile(folder / output / "report.json");
    }

    Folder folder;
};

TEST_F(BallLadder, PutsOneMeshALevelAndAReportIntoItsFolder) {
    ladder({});
    std::set<std::string> expected{"report.json"};
    const Json levels = report()["levels"];
    ASSERT_GE(levels.size(), 3u);
    for (std::size_t i = 0; i < levels.size(); ++i)
        if (!levels[i]["file"].is_null()) {
            EXPECT_EQ(levels[i]["file"], "ball_L" + std::to_string(i) + ".ply");
            expected.insert(levels[i]["file"].get<std::string>());
        }
    EXPECT_EQ(namesIn(folder / "out/ball"), expected);
    EXPECT_EQ(namesIn(folder / "out"), std::set<std::string>{"ball"});
}

TEST_F(BallLadder, ReportsTheDocumentedKeys) {
    ladder({});
    const Json r = report();
    EXPECT_EQ(keysOf(r), (std::set<std::string>{"version", "input", "fit", "K", "first_levels", "levels",
                                                "budgets", "steps", "coefficients_stored", "control_points",
                                                "seconds", "peak_memory_bytes", "threads", "remarks"}));
    EXPECT_FALSE(r["remarks"].empty()) << "the image, and how thick its walls are";
    EXPECT_EQ(keysOf(r["input"]), (std::set<std::string>{"path", "kind", "format", "component_type",
                                                         "dimensions", "spacing", "range", "iso", "inverted",
                                                         "open_border", "origin", "direction", "space"}));
    EXPECT_EQ(keysOf(r["fit"]),
              (std::set<std::string>{"method", "half_width", "band", "lattice_points", "disagreeing",
                                     "repair_passes", "repaired", "repair_floor", "stopped"}));
    for (const Json& level : r["levels"])
        EXPECT_EQ(keysOf(level), (std::set<std::string>{"step",
                                                        "level",
                                                        "file",
                                                        "spacing",
                                                        "control_points",
                                                        "nodes",
                                                        "leaf_occupancy",
                                                        "memory_bytes",
                                                        "vertices",
                                                        "triangles",
                                                        "components",
                                                        "genus",
                                                        "closed",
                                                        "manifold",
                                                        "volume",
                                                        "area",
                                                        "parts",
                                                        "cavities",
                                                        "specks_removed",
                                                        "speck_volume",
                                                        "bubbles_removed",
                                                        "bubble_volume",
                                                        "iso_shift",
                                                        "iso_distance",
                                                        "volume_at_iso_0",
                                                        "volume_error",
                                                        "thin_kept",
                                                        "thin_kept_at_iso_0",
                                                        "features",
                                                        "walls",
                                                        "hold",
                                                        "regions",
                                                        "cuts",
                                                        "fills",
                                                        "limits_missed",
                                                        "change",
                                                        "refine",
                                                        "sampling",
                                                        "cuts",
                                                        "fills",
                                                        "limits_missed",
                                                        "rms_to_level0",
                                                        "max_to_level0",
                                                        "rms_from_level0",
                                                        "max_from_level0",
                                                        "rms_to_level0_error",
                                                        "rms_from_level0_error",
                                                        "to_input",
                                                        "max_deviation",
                                                        "rms_deviation",
                                                        "seconds"}));
    EXPECT_EQ(r["version"], 1);
    EXPECT_EQ(r["input"]["kind"], "grey image");
    EXPECT_EQ(r["input"]["dimensions"], Json({32, 32, 32}));
    EXPECT_EQ(r["input"]["spacing"], Json({0.5, 0.5, 0.5}));
    EXPECT_EQ(r["fit"]["method"], "distance");
    EXPECT_EQ(r["fit"]["disagreeing"], 0);
    EXPECT_EQ(r["fit"]["stopped"], "agreed");
    EXPECT_DOUBLE_EQ(r["fit"]["repair_floor"].get<double>(), 1e-4 / r["fit"]["half_width"].get<double>());
    EXPECT_GT(r["peak_memory_bytes"].get<double>(), 1e6);
    // Of a leaf's 512 lattice points, 4 bytes each, so many are control points.
    const Json& finest = r["levels"][0];
    const double occupancy = finest["leaf_occupancy"], points = finest["control_points"];
    EXPECT_GT(occupancy, 0.1);  // seen 0.37
    EXPECT_LE(occupancy, 1);
    EXPECT_GT(finest["memory_bytes"].get<double>(), 4 * points / occupancy);
    EXPECT_GE(r["seconds"]["total"].get<double>(), r["seconds"]["analyse"].get<double>());
}

TEST_F(BallLadder, WritesTheLevelsThatWereAskedFor) {
    ladder({"--levels", "1..2"});
    EXPECT_EQ(namesIn(folder / "out/ball"),
              (std::set<std::string>{"ball_L1.ply", "ball_L2.ply", "report.json"}));
    EXPECT_GT(report()["levels"][0]["rms_to_level0"].get<double>(), 0)
        << "measured against level 0 all the same";
    ladder({"--steps", "1..3"}, "out/s");
    EXPECT_EQ(namesIn(folder / "out/s"),
              (std::set<std::string>{"s_s1.ply", "s_s2.ply", "s_s3.ply", "report.json"}));
    EXPECT_EQ(report("out/s")["levels"][0]["level"], nullptr);
    EXPECT_EQ(report("out/s")["levels"][2]["level"], 1);
    EXPECT_EQ(contentOf(folder / "out/s/s_s3.ply"), contentOf(folder / "out/ball/ball_L1.ply"));
    ladder({"--levels", "1"}, "out/one");
    EXPECT_EQ(namesIn(folder / "out/one"), (std::set<std::string>{"one_L1.ply", "report.json"}));
}

TEST_F(BallLadder, WritesEveryFormat) {
    for (const std::string format : {"stl", "ply", "obj", "off", "glb"}) {
        ladder({"--levels", "0..1", "--format", format}, "out/" + format);
        EXPECT_EQ(namesIn(folder / ("out/" + format)),
                  (std::set<std::string>{format + "_L0." + format, format + "_L1." + format, "report.json"}));
        if (format == "glb") continue;  // the one format that isowave does not read
        const Json check =
            succeed(
                {"check", (folder / ("out/" + format) / (format + "_L0." + format)).string(), "--json", "-"})
                .json();
        EXPECT_EQ(check["triangles"], report("out/" + format)["levels"][0]["triangles"]) << format;
        EXPECT_NEAR(check["volume"].get<double>(),
                    report("out/" + format)["levels"][0]["volume"].get<double>(), 1e-3);
    }
}

TEST_F(BallLadder, WritesTheSameBytesForEveryNumberOfThreads) {
    ladder({"--threads", "1"}, "out1/ball");
    for (const std::string threads : {"2", "4"}) {
        ladder({"--threads", threads}, "out" + threads + "/ball");
        EXPECT_EQ(namesIn(folder / ("out" + threads) / "ball"), namesIn(folder / "out1/ball"));
        for (const std::string& name : namesIn(folder / "out1/ball")) {
            if (name == "report.json") continue;
            EXPECT_EQ(contentOf(folder / ("out" + threads) / "ball" / name),
                      contentOf(folder / "out1/ball" / name));
        }
        // The reports agree but for time, memory and the number of threads itself.
        Json one = report("out1/ball"), other = report("out" + threads + "/ball");
        for (Json* r : {&one, &other}) {
            for (const char* key : {"seconds", "peak_memory_bytes", "threads"}) r->erase(key);
            for (Json& level : (*r)["levels"]) level.erase("seconds");
        }
        EXPECT_EQ(one, other);
    }
}

TEST_F(BallLadder, GivesTheReportToAFileOrToStandardOutputToo) {
    ladder({"--json", (folder / "copy.json").string()});
    EXPECT_EQ(contentOf(folder / "copy.json"), contentOf(folder / "out/ball/report.json"));
    const Result piped = ladder({"--json", "-"});
    EXPECT_EQ(piped.json(), report());
}

TEST_F(BallLadder, TalksOnStandardErrorAndIsQuietWhenAsked) {
    const Result loud = ladder({});
    EXPECT_NE(loud.err.find("distance fit"), std::string::npos);
    EXPECT_NE(loud.out.find("ball_L1.ply"), std::string::npos);
    const Result quiet = ladder({"--quiet"});
    EXPECT_EQ(quiet.err, "");
    EXPECT_EQ(quiet.out, loud.out);
}

TEST_F(BallLadder, ReplacesAnEarlierLadderAndLeavesOtherFilesAlone) {
    ladder({"--levels", "0"});
    std::ofstream(folder / "out/ball/notes.txt") << "mine";
    const std::string before = contentOf(folder / "out/ball/ball_L0.ply");
    succeed({"lod", (folder / "ball.nrrd").string(), "--iso", "40", "--levels", "0", "-o",
             (folder / "out/ball/").string()});  // with a slash at the end: the same folder
    EXPECT_NE(contentOf(folder / "out/ball/ball_L0.ply"), before);
    EXPECT_EQ(contentOf(folder / "out/ball/notes.txt"), "mine");
    EXPECT_EQ(namesIn(folder / "out/ball"),
              (std::set<std::string>{"ball_L0.ply", "notes.txt", "report.json"}));
}

TEST_F(BallLadder, EndsWhereTheSolidVanishes) {
    writeNrrd(folder / "ball.nrrd", kSize, greyBall(kSize, 3), "spacings: 1 1 1\n");
    ladder({});
    const Json levels = report()["levels"];
    ASSERT_EQ(levels.back()["triangles"], 0);
    for (const Json& level : levels) {
        const bool vanished = level["triangles"] == 0;
        EXPECT_EQ(level["file"].is_null(), vanished);
        if (vanished) {
            EXPECT_EQ(level, levels.back()) << "nothing comes after it";
            EXPECT_EQ(level["rms_to_level0"], nullptr);
        }
    }
}

// ---- kinds of images ----

// 256 x 256 x 400 voxels: 26 MB as a file, 105 MB as floats.
TEST(LargeImage, IsNeverInMemoryAsAWholeAndGivesTheSameForEveryNumberOfThreads) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
    const Folder folder;
    const Size size{256, 256, 400};
    writeNrrd(folder / "rod.nrrd", size, sampled<std::uint8_t>(size, [](int x, int y, int z) {
                  return std::hypot(x - 126.3, y - 130.2) < 60 + z % 160 / 8 && z > 8 && z < 390;
              }));
    std::string first;
    for (const std::string threads : {"1", "2", "4"}) {
        succeed({"lod", (folder / "rod.nrrd").string(), "--levels", "2", "--threads", threads, "-o",
                 (folder / "out").string()});
        const Json report = jsonFile(folder / "out/report.json");
        EXPECT_EQ(report["levels"][0]["components"], 1);
        EXPECT_LT(report["peak_memory_bytes"].get<double>(), 210e6) << threads;
        const std::string mesh = contentOf(folder / "out/rod_L2.ply");
        if (first.empty()) first = mesh;
        EXPECT_EQ(mesh, first) << threads;
    }
}

TEST(Headerless, ImagesAreReadAsTheOptionsSay) {
    const Folder folder;
    const Size size{20, 24, 28};
    auto values = greyBall(size, 6);
    for (std::int16_t& v : values)  // big-endian
        v = static_cast<std::int16_t>(static_cast<std::uint16_t>(v) << 8 |
                                      static_cast<std::uint16_t>(v) >> 8);
    std::ofstream out(folder / "a.bin", std::ios::binary);
    out << "12345";
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(2 * values.size()));
    out.close();
    succeed({"lod", (folder / "a.bin").string(), "--iso", "0", "--size", "20x24x28", "--type", "int16",
             "--spacing", "1x1x2", "--endian", "big", "--header-bytes", "5", "--levels", "0", "-o",
             (folder / "o").string()});
    const Json report = jsonFile(folder / "o/report.json");
    EXPECT_EQ(report["input"]["dimensions"], Json({20, 24, 28}));
    EXPECT_EQ(report["input"]["spacing"], Json({1.0, 1.0, 2.0}));
    EXPECT_NEAR(report["levels"][0]["volume"].get<double>(), 2 * 4.0 / 3.0 * kPi * 216, 60);
}

TEST(Space, IsNotSaidWhereTheFileDoesNotSayIt) {
    const Folder folder;
    const Size size{24, 20, 16};
    writeNrrd(folder / "a.nrrd", size, greyBall(size, 5), "spacings: 1 1 1\n");
    const Arguments lod{"lod", (folder / "a.nrrd").string(), "--iso", "0", "--levels", "0", "--format",
                        "obj"};
    Arguments plain = lod, ras = lod;
    plain.insert(plain.end(), {"-o", (folder / "o").string()});
    ras.insert(ras.end(), {"--space", "ras", "-o", (folder / "ras").string()});
    succeed(plain);
    EXPECT_EQ(jsonFile(folder / "o/report.json")["input"]["space"], "unspecified");
    EXPECT_EQ(contentOf(folder / "o/o_L0.obj").find("SPACE="), std::string::npos);
    const Result refused = isowave(ras);
    EXPECT_EQ(refused.exitCode, 2);
    EXPECT_THAT(refused.err, HasSubstr("names no sides of a body"));
    EXPECT_FALSE(fs::exists(folder / "ras"));
}

TEST(Space, RasNegatesXAndY) {
    const Folder folder;
    const Size size{24, 20, 16};
    writeNrrd(folder / "a.nrrd", size, greyBall(size, 5),
              "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: "
              "(100,40,-7)\n");
    const auto bounds = [&](const std::string& space) {
        succeed({"lod", (folder / "a.nrrd").string(), "--iso", "0", "--levels", "0", "--format", "obj",
                 "--space", space, "-o", (folder / space).string()});
        const std::string text = contentOf(folder / space / (space + "_L0.obj"));
        EXPECT_NE(text.find(space == "ras" ? "SPACE=RAS" : "SPACE=LPS"), std::string::npos);
        std::istringstream lines(text);
        std::string line;
        double x = 0, y = 0;
        int count = 0;
        while (std::getline(lines, line))
            if (line.rfind("v ", 0) == 0) {
                std::istringstream numbers(line.substr(2));
                double px = 0, py = 0;
                numbers >> px >> py;
                x += px, y += py, ++count;
            }
        return std::array<double, 2>{x / count, y / count};
    };
    const auto lps = bounds("lps"), ras = bounds("ras");
    EXPECT_NEAR(lps[0], 111.5, 0.05);  // the ball's centre
    EXPECT_NEAR(lps[1], 49.5, 0.05);
    EXPECT_NEAR(ras[0], -111.5, 0.05);
    EXPECT_NEAR(ras[1], -49.5, 0.05);
    // Read again, both lie where the image does.
    const Json same = succeed({"compare", (folder / "lps/lps_L0.obj").string(),
                               (folder / "ras/ras_L0.obj").string(), "--json", "-"})
                          .json();
    EXPECT_LT(same["symmetric"]["max"].get<double>(), 1e-4);
}

// ---- meshes ----

TEST(MeshLadder, KeepsTheAxesThatAMeshNames) {
    const Folder folder;
    writePly(folder / "ras.ply", torus(20, 8), "SPACE=RAS");
    succeed({"lod", (folder / "ras.ply").string(), "--voxels", "32", "--levels", "0", "-o",
             (folder / "o").string()});
    EXPECT_EQ(jsonFile(folder / "o/report.json")["input"]["space"], "ras");
    EXPECT_NE(contentOf(folder / "o/o_L0.ply").find("SPACE=RAS"), std::string::npos);
    const Json same =
        succeed({"compare", (folder / "ras.ply").string(), (folder / "o/o_L0.ply").string(), "--json", "-"})
            .json();
    EXPECT_LT(same["symmetric"]["rms"].get<double>(), 0.5);
}

TEST(MeshLadder, LiftsTheMemoryLimitWhenTold) {
    const Folder folder;
    writeStl(folder / "torus.stl", torus(20, 8));
    const Arguments arguments{"lod", (folder / "torus.stl").string(), "--voxels",    "48", "--levels", "0",
                              "-o",  (folder / "o").string(),         "--max-memory"};
    const auto with = [&](const std::string& gigabytes) {
        Arguments all = arguments;
        all.push_back(gigabytes);
        return isowave(all).exitCode;
    };
    EXPECT_EQ(with("0.001"), 3);
    EXPECT_EQ(with("8"), 0);
}

}  // namespace
}  // namespace isowave::tools_test
