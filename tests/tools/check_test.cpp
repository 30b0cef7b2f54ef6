// check and compare: they see every defect, and they measure what geometry says.
#include <set>

#include "tests/tools/inputs.h"
#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using Json = nlohmann::json;

Json check(const fs::path& file, int exitCode) {
    const Result result = isowave({"check", file.string(), "--json", "-"});
    EXPECT_EQ(result.exitCode, exitCode) << result.err;
    EXPECT_EQ(result.err, "");
    return result.json();
}

TEST(Check, SpeaksOfOneTriangleInTheSingular) {
    const Folder folder;
    writeOff(folder / "a.off", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    const std::string text = isowave({"check", (folder / "a.off").string()}).out;
    EXPECT_NE(text.find(": 1 triangle, 3 vertices\n"), std::string::npos) << text;
    EXPECT_NE(text.find(" 1 component,"), std::string::npos) << text;
}

TEST(Check, FindsNothingWrongWithATorus) {
    const Folder folder;
    writeStl(folder / "a.stl", torus(20, 8));
    const Json json = check(folder / "a.stl", 0);
    std::set<std::string> keys;
    for (const auto& item : json.items()) keys.insert(item.key());
    EXPECT_EQ(keys,
              (std::set<std::string>{"version", "input", "vertices", "triangles", "components", "genus",
                                     "closed", "manifold", "volume", "area", "oriented", "boundary_edges",
                                     "non_manifold_edges", "non_manifold_vertices", "misoriented_edges",
                                     "degenerate_triangles", "self_intersections", "each", "remarks"}));
    EXPECT_EQ(json["genus"], 1);
    EXPECT_EQ(json["components"], 1);
    EXPECT_EQ(json["closed"], true);
    EXPECT_EQ(json["manifold"], true);
    EXPECT_EQ(json["oriented"], true);
    EXPECT_EQ(json["self_intersections"], nullptr) << "not counted unless asked";
    EXPECT_EQ(json["each"][0]["euler"], 0);
    const double volume = 2 * std::pow(std::acos(-1.0), 2) * 20 * 64;
    EXPECT_NEAR(json["volume"].get<double>(), volume, 0.03 * volume);
    EXPECT_EQ(isowave({"check", (folder / "a.stl").string()}).exitCode, 0);
}

TEST(Check, SeesAMissingTriangle) {
    const Folder folder;
    SmallMesh mesh = torus(20, 8);
    mesh.triangles.pop_back();
    writeStl(folder / "a.stl", mesh);
    const Json json = check(folder / "a.stl", 4);
    EXPECT_EQ(json["closed"], false);
    EXPECT_EQ(json["boundary_edges"], 3);
    EXPECT_EQ(json["genus"], nullptr);
}

TEST(Check, SeesATurnedTriangle) {
    const Folder folder;
    SmallMesh mesh = torus(20, 8);
    std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
    writeStl(folder / "a.stl", mesh);
    const Json json = check(folder / "a.stl", 4);
    EXPECT_EQ(json["oriented"], false);
    EXPECT_EQ(json["misoriented_edges"], 3);
    EXPECT_EQ(json["closed"], true);
}

TEST(Check, SeesAnEdgeWithFourTriangles) {
    const Folder folder;
    // Two tetrahedra that share the edge 0-1.
    SmallMesh mesh{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
                   {{0, 3, 2}, {0, 1, 3}, {0, 2, 1}, {1, 2, 3}, {0, 5, 4}, {0, 1, 5}, {0, 4, 1}, {1, 4, 5}}};
    writeOff(folder / "a.off", mesh);
    const Json json = check(folder / "a.off", 4);
    EXPECT_EQ(json["manifold"], false);
    EXPECT_EQ(json["non_manifold_edges"], 1);
}

TEST(Check, SeesTwoPartsThatTouchInOnePoint) {
    const Folder folder;
    SmallMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
                   {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}}};
    writeOff(folder / "a.off", mesh);
    const Json json = check(folder / "a.off", 4);
    EXPECT_EQ(json["non_manifold_vertices"], 1);
    EXPECT_EQ(json["closed"], true);
}

TEST(Check, CountsPairsOfTrianglesThatIntersect) {
    const Folder folder;
    SmallMesh two = torus(20, 8, 12, 8), other = torus(20, 8, 12, 8);
    const int base = static_cast<int>(two.points.size());
    for (auto p : other.points) two.points.push_back({p[0] + 3, p[1] + 5, p[2] + 1});
    for (auto t : other.triangles) two.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    writeOff(folder / "two.off", two);
    writeOff(folder / "one.off", other);
    const auto count = [&](const char* name) {
        const Result r = isowave({"check", (folder / name).string(), "--self-intersections", "--json", "-"});
        return r.json()["self_intersections"].get<std::int64_t>();
    };
    EXPECT_EQ(count("one.off"), 0);
    EXPECT_GT(count("two.off"), 0);
    EXPECT_EQ(check(folder / "two.off", 0)["components"], 2);
}

TEST(Check, MergesEqualPointsAndRepairsNothing) {
    const Folder folder;
    SmallMesh soup;
    const SmallMesh whole = torus(20, 8);
    for (const auto& t : whole.triangles) {
        const int base = static_cast<int>(soup.points.size());
        for (const int corner : t) soup.points.push_back(whole.points[corner]);
        soup.triangles.push_back({base, base + 1, base + 2});
    }
    writeOff(folder / "soup.off", soup);
    const Json json = check(folder / "soup.off", 0);
    EXPECT_EQ(json["vertices"], whole.points.size());
    EXPECT_EQ(json["genus"], 1);
}

TEST(Compare, MeasuresAShift) {
    const Folder folder;
    SmallMesh a = torus(20, 8), b = a;
    for (auto& p : b.points) p[2] += 0.5;
    writeOff(folder / "a.off", a);
    writeOff(folder / "b.off", b);
    const Json json =
        succeed({"compare", (folder / "a.off").string(), (folder / "b.off").string(), "--json", "-"}).json();
    for (const char* side : {"a_to_b", "b_to_a", "symmetric"}) {
        EXPECT_LT(json[side]["max"].get<double>(), 0.5001) << side;
        EXPECT_GT(json[side]["max"].get<double>(), 0.45) << side;
        EXPECT_LT(json[side]["rms"].get<double>(), json[side]["max"].get<double>()) << side;
        EXPECT_LE(json[side]["mean"].get<double>(), json[side]["rms"].get<double>()) << side;
        EXPECT_GE(json[side]["max_bound"].get<double>(), json[side]["max"].get<double>()) << side;
    }
    EXPECT_NEAR(json["volume_difference"].get<double>(), 0, 1e-6);
    const Json self =
        succeed({"compare", (folder / "a.off").string(), (folder / "a.off").string(), "--json", "-"}).json();
    EXPECT_LT(self["symmetric"]["max"].get<double>(), 1e-9);
}

TEST(Compare, TellsOneSideFromTheOther) {
    const Folder folder;
    SmallMesh a = torus(20, 8), both = a;
    const int base = static_cast<int>(both.points.size());
    for (const auto& p : a.points) both.points.push_back({p[0] + 100, p[1], p[2]});
    for (const auto& t : a.triangles) both.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    writeOff(folder / "a.off", a);
    writeOff(folder / "both.off", both);
    const Json json =
        succeed({"compare", (folder / "a.off").string(), (folder / "both.off").string(), "--json", "-"})
            .json();
    EXPECT_LT(json["a_to_b"]["max"].get<double>(), 1e-9);
    EXPECT_GT(json["b_to_a"]["max"].get<double>(), 60);
    EXPECT_NEAR(json["volume_difference"].get<double>(), json["a"]["volume"].get<double>(), 1e-6);
}

TEST(Compare, BoundsTheDistanceToOnePercentAtAnySampling) {
    const Folder folder;
    writeOff(folder / "a.off", torus(20, 8, 24, 12));
    writeOff(folder / "b.off", torus(20, 8, 48, 24));
    for (const char* sampling : {"10", "0.5"}) {
        const Json json = succeed({"compare", (folder / "a.off").string(), (folder / "b.off").string(),
                                   "--json", "-", "--sampling", sampling})
                              .json()["symmetric"];
        EXPECT_GE(json["max_bound"].get<double>(), json["max"].get<double>()) << sampling;
        EXPECT_LE(json["max_bound"].get<double>(), 1.0101 * json["max"].get<double>()) << sampling;
    }
}

}  // namespace
}  // namespace isowave::tools_test
