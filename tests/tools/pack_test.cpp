// isowave pack, and everything that takes what it writes.
#include <gmock/gmock.h>

#include "tests/tools/inputs.h"
#include "tests/tools/refusal.h"

namespace isowave::tools_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class PackedTorus : public ::testing::Test {
  protected:
    PackedTorus() { writeStl(folder / "torus.stl", torus(20, 8)); }
    std::string at(const std::string& name) const { return (folder / name).string(); }
    Json pack(std::vector<std::string> options, const std::string& name) const {
        options.insert(options.begin(),
                       {"pack", at("torus.stl"), "--voxels", "40", "--json", "-", "-o", at(name)});
        return succeed(options).json();
    }
    void expectRefused(const std::vector<std::string>& arguments, int exitCode,
                       const std::string& text) const {
        tools_test::expectRefused(folder, arguments, exitCode, text);
    }
    Folder folder;
};

TEST_F(PackedTorus, GivesWhatTheSolidGives) {
    EXPECT_TRUE(pack({}, "torus.iwz")["lossless"]);
    const std::vector<std::string> solid{at("torus.stl"), "--voxels", "40"}, packed{at("torus.iwz")};
    const auto run = [&](const std::string& command, const std::vector<std::string>& input,
                         std::vector<std::string> more) {
        std::vector<std::string> all{command};
        all.insert(all.end(), input.begin(), input.end());
        all.insert(all.end(), more.begin(), more.end());
        succeed(all);
    };
    const std::vector<std::array<std::string, 4>> commands{{"analyse", "a.vdb", "", ""},
                                                           {"mesh", "m.ply", "--level", "1"},
                                                           {"mesh", "n.stl", "--step", "0"},
                                                           {"field", "f.vdb", "--step", "2"}};
    for (const auto& [command, name, option, value] : commands) {
        std::vector<std::string> options;
        if (!option.empty()) options = {option, value};
        options.insert(options.end(), {"-o", at("1" + name)});
        run(command, solid, options);
        options.back() = at("2" + name);
        run(command, packed, options);
        EXPECT_EQ(contentOf(at("1" + name)), contentOf(at("2" + name))) << command;
    }
}

TEST_F(PackedTorus, IsAnInputOfLodAndInfo) {
    pack({}, "torus.iwz");
    succeed({"lod", at("torus.stl"), "--voxels", "40", "-o", at("direct")});
    succeed({"lod", at("torus.iwz"), "-o", at("again")});
    const Json direct = jsonFile(at("direct/report.json")), again = jsonFile(at("again/report.json"));
    EXPECT_EQ(again["input"]["source"]["path"], direct["input"]["path"]);
    EXPECT_EQ(again["fit"], direct["fit"]);
    EXPECT_EQ(again["coefficients_stored"], direct["coefficients_stored"]);
    ASSERT_EQ(again["levels"].size(), direct["levels"].size());
    for (std::size_t i = 0; i < direct["levels"].size(); ++i)
        EXPECT_EQ(again["levels"][i]["triangles"], direct["levels"][i]["triangles"]);
    const Json info = succeed({"info", at("torus.iwz"), "--json", "-"}).json();
    EXPECT_TRUE(info["packed"]);
    EXPECT_EQ(info["control_points"], direct["control_points"]);
}

TEST_F(PackedTorus, PacksAPyramidAndWhatIsPackedAlready) {
    pack({}, "torus.iwz");
    succeed({"pack", at("torus.iwz"), "-o", at("again.iwz")});
    EXPECT_EQ(contentOf(at("again.iwz")), contentOf(at("torus.iwz")));
    succeed({"analyse", at("torus.stl"), "--voxels", "40", "-o", at("torus.pyramid.vdb")});
    succeed({"pack", at("torus.pyramid.vdb"), "-o", at("pyramid.iwz")});
    succeed({"mesh", at("torus.pyramid.vdb"), "--step", "0", "-o", at("a.ply")});
    succeed({"mesh", at("pyramid.iwz"), "--step", "0", "-o", at("b.ply")});
    EXPECT_EQ(contentOf(at("a.ply")), contentOf(at("b.ply")));
    EXPECT_LT(5 * fs::file_size(at("pyramid.iwz")), 2 * fs::file_size(at("torus.pyramid.vdb")));
}

TEST_F(PackedTorus, KeepsABoundInEitherUnit) {
    const Json a = pack({"--bound", "0.1voxel"}, "a.iwz");
    EXPECT_FALSE(a["lossless"]);
    EXPECT_LE(a["change_voxels"]["max"], 0.1);
    // A torus of 56 mm at 40 voxels: 1.4 mm a voxel.
    const Json b = pack({"--bound", "0.014mm"}, "b.iwz");
    EXPECT_NEAR(b["bound_voxels"].get<double>(), 0.01, 1e-4);
    EXPECT_LT(a["bytes"], b["bytes"]);
    EXPECT_LT(b["bytes"], pack({}, "c.iwz")["bytes"]);
    const Result result = succeed({"mesh", at("a.iwz"), "-o", at("a.ply")});
    EXPECT_THAT(result.err, HasSubstr("within 0.1 voxels"));
}

// The vertices themselves, read from two meshes.
TEST_F(PackedTorus, KeepsVerticesWithinMaxDistance) {
    const Json json = pack({"--bound", "0.3voxel", "--max-distance", "0.05mm"}, "a.iwz");
    EXPECT_LE(json["vertex_distance"]["max"], 0.05);
    succeed({"mesh", at("torus.stl"), "--voxels", "40", "-o", at("a.off")});
    succeed({"mesh", at("a.iwz"), "-o", at("b.off")});
    std::ifstream a(at("a.off")), b(at("b.off"));
    std::string word;
    std::size_t points = 0, triangles = 0, ignored = 0;
    for (std::ifstream* in : {&a, &b}) *in >> word >> points >> triangles >> ignored;
    ASSERT_EQ(triangles, json["triangles"].get<std::size_t>());
    double largest = 0;
    for (std::size_t i = 0; i < points; ++i) {
        std::array<double, 3> p{}, q{};
        for (double& v : p) a >> v;
        for (double& v : q) b >> v;
        largest = std::max(largest, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    }
    EXPECT_LE(largest, 0.0501);
    EXPECT_GT(largest, 0.001);
    std::string restA((std::istreambuf_iterator<char>(a)), {}),
        restB((std::istreambuf_iterator<char>(b)), {});
    EXPECT_EQ(restA, restB) << "triangles";
}

TEST_F(PackedTorus, RefusesBadLengthsNamesAndFiles) {
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"pack", at("torus.stl"), "--voxels", "40"});
        return more;
    };
    expectRefused(with({"-o", at("a.vdb")}), 2, ".iwz");
    for (const std::string bad : {"0voxel", "-1mm", "nan", "0.1", "mm", "1furlong", "1e999voxel"})
        expectRefused(with({"--bound", bad, "-o", at("a.iwz")}), 2, "--bound");
    expectRefused(with({"--max-distance", "0mm", "-o", at("a.iwz")}), 2, "--max-distance");
    expectRefused(
        with({"--bound", "5voxel", "-o", at("a.iwz")}), 2,
        "--bound is 5 voxels; at most 4voxel is possible, the distance up to which the field is known");
    expectRefused(with({"--max-distance", "1e9mm", "-o", at("a.iwz")}), 2, "--max-distance is ");
    std::ofstream(at("bad.iwz")) << "not packed";
    expectRefused({"mesh", at("bad.iwz"), "-o", at("a.ply")}, 3, "is no packed solid");
    pack({}, "torus.iwz");
    std::string bytes = contentOf(at("torus.iwz"));
    std::ofstream(at("cut.iwz"), std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    expectRefused({"mesh", at("cut.iwz"), "-o", at("a.ply")}, 3, "truncated");
    bytes[bytes.size() / 2] ^= 1;
    std::ofstream(at("flip.iwz"), std::ios::binary) << bytes;
    expectRefused({"lod", at("flip.iwz"), "-o", at("out")}, 3, "checksum");
    expectRefused({"info", at("flip.iwz")}, 3, "checksum");
}

}  // namespace
}  // namespace isowave::tools_test
