// reverse, rebuild, subdivide: the program itself on real cages and on bad input.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/tools/run_isowave.h"

namespace isowave::tools_test {
namespace {

using testing::HasSubstr;

const std::string kCages = std::string(ISOWAVE_TEST_DATA) + "/subdiv/";

std::string in(const Folder& folder, const std::string& name) { return (folder / name).string(); }

// The numbers of all `v` lines, and all `f` lines as they are.
struct Obj {
    std::vector<double> points;
    std::vector<std::string> faces;
};
Obj readObj(const fs::path& path) {
    Obj obj;
    std::istringstream lines(contentOf(path));
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("f ", 0) == 0) obj.faces.push_back(line);
        if (line.rfind("v ", 0) != 0) continue;
        std::istringstream numbers(line.substr(2));
        for (double x; numbers >> x;) obj.points.push_back(x);
    }
    return obj;
}
double largestDifference(const Obj& a, const Obj& b) {
    if (a.points.size() != b.points.size()) return INFINITY;
    double most = 0;
    for (std::size_t i = 0; i < a.points.size(); ++i)
        most = std::max(most, std::abs(a.points[i] - b.points[i]));
    return most;
}

// Every number moved a little, the same way each time.
void roughen(const fs::path& from, const fs::path& to) {
    std::istringstream lines(contentOf(from));
    std::ofstream out(to);
    unsigned state = 1;
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("v ", 0) != 0) {
            out << line << "\n";
            continue;
        }
        std::istringstream numbers(line.substr(2));
        out << "v";
        for (double x; numbers >> x;) {
            state = state * 1664525u + 1013904223u;
            out << ' ' << x + 0.002 * (state / 4294967296.0 - 0.5);
        }
        out << "\n";
    }
}

TEST(Reverse, TakesACarApartAndRebuildPutsItBack) {
    const Folder folder;
    succeed(
        {"subdivide", kCages + "catmark_car.obj", "--depth", "2", "-o", in(folder, "smooth.obj"), "--quiet"});
    roughen(folder / "smooth.obj", folder / "fine.obj");
    const auto report = succeed({"reverse", in(folder, "fine.obj"), "-o", in(folder, "base.obj"), "--depth",
                                 "2", "--details", in(folder, "car.details"), "--json", "-"})
                            .json();
    EXPECT_EQ(report["levels"][0]["vertices"], 1642);
    EXPECT_EQ(report["creases"], 314);
    EXPECT_EQ(report["scheme"], "catmull-clark");
    EXPECT_LT(report["levels"][1]["without_details"]["rms"], report["levels"][0]["without_details"]["rms"]);
    succeed({"rebuild", in(folder, "base.obj"), "--details", in(folder, "car.details"), "-o",
             in(folder, "back.obj")});
    const Obj fine = readObj(folder / "fine.obj"), back = readObj(folder / "back.obj");
    EXPECT_LT(largestDifference(fine, back), 1e-11);
    EXPECT_EQ(fine.faces, back.faces) << "the same faces in the same order";
    // A level between, in another format.
    const auto middle = succeed({"rebuild", in(folder, "base.obj"), "--details", in(folder, "car.details"),
                                 "--depth", "1", "-o", in(folder, "new/middle.ply"), "--json", "-"})
                            .json();
    EXPECT_EQ(middle["vertices"], report["levels"][1]["vertices"]);
    EXPECT_TRUE(fs::exists(folder / "new/middle.ply"));
    // The options reach rebuild(); what they do is tested there.
    const auto part = succeed({"rebuild", in(folder, "base.obj"), "--details", in(folder, "car.details"),
                               "-o", in(folder, "part.obj"), "--edited", in(folder, "base.obj"), "--frames",
                               "local", "--keep", "100", "--error-table", "--json", "-"})
                          .json();
    EXPECT_EQ(part["kept"], 100);
    EXPECT_EQ(part["shares"].size(), 7u);
    EXPECT_THAT(succeed({"rebuild", in(folder, "base.obj"), "--details", in(folder, "car.details"), "-o",
                         in(folder, "part.obj"), "--threshold", "0.0005"})
                    .out,
                HasSubstr("without the others rms"));
}

TEST(Reverse, KeepsTheLongestDetailsInASmallerFile) {
    const Folder folder;
    succeed(
        {"subdivide", kCages + "catmark_car.obj", "--depth", "2", "-o", in(folder, "smooth.obj"), "--quiet"});
    roughen(folder / "smooth.obj", folder / "fine.obj");
    const auto reverse = [&](const char* name, std::vector<std::string> more) {
        std::vector<std::string> arguments{"reverse",   in(folder, "fine.obj"),
                                           "-o",        in(folder, "base.obj"),
                                           "--depth",   "2",
                                           "--details", in(folder, name),
                                           "--json",    "-"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return succeed(arguments).json();
    };
    const auto whole = reverse("whole", {}), part = reverse("part", {"--keep", "1000"});
    EXPECT_EQ(whole["kept"], whole["details"]);
    EXPECT_EQ(whole["dropped"]["largest"], 0);
    EXPECT_EQ(part["kept"], 1000);
    EXPECT_GT(part["dropped"]["rms"], 0);
    EXPECT_LT(5 * fs::file_size(folder / "part"), 2 * fs::file_size(folder / "whole"));  // seen 2.8 times
    // What rebuild makes of it is what it makes of the whole file with --keep.
    const auto rebuild = [&](const char* details, const char* out, std::vector<std::string> more) {
        std::vector<std::string> arguments{
            "rebuild", in(folder, "base.obj"), "--details", in(folder, details),
            "-o",      in(folder, out),        "--quiet"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        succeed(arguments);
        return contentOf(folder / out);
    };
    EXPECT_EQ(rebuild("part", "a.obj", {}), rebuild("whole", "b.obj", {"--keep", "1000"}));
    const auto refused = [&](std::vector<std::string> more, const char* says) {
        std::vector<std::string> arguments{"reverse", in(folder, "fine.obj"), "-o", in(folder, "x.obj")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, 2);
        EXPECT_EQ(result.errorLines(), 1);
        EXPECT_THAT(result.err, HasSubstr(says));
    };
    refused({"--keep", "10"}, "--keep: says what goes into the file of --details");
    refused({"--threshold", "nan", "--details", in(folder, "d")}, "--threshold");
    refused({"--keep", "-1", "--details", in(folder, "d")}, "--keep");
    refused({"--keep", "1", "--threshold", "1", "--details", in(folder, "d")}, "give one of them");
    EXPECT_FALSE(fs::exists(folder / "x.obj"));
    EXPECT_FALSE(fs::exists(folder / "d"));
}

// The masks are tested in the library. A corner (1, 1, 1) of a cube has 9 v' = (5, 5, 5), sum(e) = (3/2, 3/2, 3/2) and
// sum(f) = (1, 1, 1), so its limit (9 v' + 4 sum(e) + sum(f))/24 is half of it.
TEST(MeshHierarchyCommands, WriteLimitPositionsThatRebuildDoesNotTake) {
    const Folder folder;
    const std::string cube = in(folder, "cube.obj"), limit = in(folder, "limit.obj"),
                      fine = in(folder, "fine.obj"), details = in(folder, "fine.details"),
                      out = in(folder, "out.obj");
    std::ofstream(cube)
        << "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
           "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    const auto report =
        succeed({"subdivide", cube, "--depth", "0", "--limit", "-o", limit, "--json", "-"}).json();
    EXPECT_EQ(report["positions"], "limit");
    const Obj before = readObj(cube), after = readObj(limit);
    ASSERT_EQ(before.points.size(), after.points.size());
    for (std::size_t k = 0; k < after.points.size(); ++k)
        EXPECT_NEAR(after.points[k], before.points[k] / 2, 1e-15);

    succeed({"subdivide", kCages + "catmark_torus.obj", "--depth", "2", "-o", in(folder, "smooth.obj")});
    roughen(folder / "smooth.obj", fine);
    const std::vector<std::string> reverse{"reverse", fine,        "--depth", "1",      "--limit", "-o",
                                           limit,     "--details", details,   "--json", "-"};
    EXPECT_EQ(succeed(reverse).json()["positions"], "limit");
    succeed({"reverse", fine, "--depth", "1", "-o", in(folder, "base.obj"), "--quiet"});
    EXPECT_GT(largestDifference(readObj(limit), readObj(folder / "base.obj")), 1e-3);
    for (const auto& arguments : std::vector<std::vector<std::string>>{
             {"rebuild", limit, "--details", details, "-o", out},
             {"rebuild", in(folder, "base.obj"), "--edited", limit, "--details", details, "-o", out}}) {
        const Result result = isowave(arguments);
        EXPECT_EQ(result.exitCode, 3);
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_THAT(result.err, HasSubstr("limit.obj: its vertices are at their limit positions"));
    }
    // The details are those of control positions, and what they rebuild may be written at its limit.
    const std::vector<std::string> rebuild{"rebuild", in(folder, "base.obj"), "--details", details, "-o",
                                           out};
    succeed(rebuild);
    EXPECT_LT(largestDifference(readObj(fine), readObj(out)), 1e-12);
    auto atLimit = rebuild;
    atLimit.insert(atLimit.end(), {"--depth", "0", "--limit", "--json", "-"});
    EXPECT_EQ(succeed(atLimit).json()["positions"], "limit");
    EXPECT_LT(largestDifference(readObj(out), readObj(limit)), 1e-14);
}

TEST(MeshHierarchyCommands, RefuseBadInputInOneLine) {
    const Folder folder;
    const std::string car = kCages + "catmark_car.obj", torus = kCages + "catmark_torus.obj";
    const std::string fine = in(folder, "fine.obj"), base = in(folder, "base.obj"),
                      details = in(folder, "torus.details"), out = in(folder, "out.obj");
    succeed({"subdivide", torus, "--depth", "1", "-o", fine});
    succeed({"reverse", fine, "-o", base, "--depth", "1", "--details", details, "--quiet"});
    const std::string quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n";
    std::ofstream(folder / "fin.obj") << quad << "f 1 2 3 4\nf 2 5 6 3\nf 2 3 4\n";
    std::ofstream(folder / "mixed.obj") << quad << "f 1 2 3 4\nf 2 3 6 5\n";
    std::ofstream(folder / "flat.obj") << quad << "f 1 2 3 4\nf 2 5 6 2\n";
    std::ofstream(folder / "text.obj") << "v 0 0 zero\n";
    std::ofstream(folder / "moved.obj") << contentOf(base).replace(0, 4, "v 9.");
    std::string damaged = contentOf(details);
    damaged[damaged.size() / 2] = char(damaged[damaged.size() / 2] ^ 1);
    std::ofstream(folder / "damaged.details", std::ios::binary) << damaged;
    std::ofstream(folder / "cut.details", std::ios::binary)
        << contentOf(details).substr(0, damaged.size() - 100);
    const struct {
        std::vector<std::string> arguments;
        int code;
        const char* says;
    } cases[] = {
        {{"reverse", in(folder, "none.obj"), "-o", out}, 3, "no such file"},
        {{"reverse", in(folder, "fin.obj"), "-o", out}, 3, "more than two faces"},
        {{"reverse", in(folder, "mixed.obj"), "-o", out}, 3, "mixed orientation"},
        {{"reverse", in(folder, "flat.obj"), "-o", out}, 3, "1 face is degenerate"},
        {{"reverse", in(folder, "text.obj"), "-o", out}, 3, "line 1: 'zero' is not a number"},
        {{"reverse", car, "-o", out}, 3, "no Catmull-Clark connectivity: vertex"},
        {{"reverse", fine, "-o", out, "--depth", "9"}, 3, "but not for 9"},
        {{"reverse", fine, "-o", out, "--scheme", "doo-sabin"}, 2, "they are catmull-clark, loop, butterfly"},
        {{"reverse", fine, "-o", out, "--variant", "best"}, 2, "they are refined, trial"},
        {{"reverse", fine, "-o", in(folder, "out.stl")}, 2, ".obj .off .ply"},
        {{"rebuild", base, "--details", details, "-o", in(folder, "out.stl")}, 2, ".obj .off .ply"},
        {{"subdivide", torus, "-o", in(folder, "out.stl")}, 2, ".obj .off .ply"},
        {{"reverse", fine, "-o", out, "--crease", "200"}, 2, "--crease"},
        {{"reverse", fine, "-o", out, "--scheme", "loop", "--crease", "30"}, 2, "--crease"},
        {{"reverse", fine}, 2, "-o"},
        {{"reverse", fine, "-o", out, "--details", fine}, 2, "what this command reads"},
        {{"reverse", fine, "-o", out, "--details", out}, 2, "would get two results"},
        {{"rebuild", base, "--details", details, "-o", base}, 2, "what this command reads"},
        {{"rebuild", base, "--details", details, "--edited", fine, "-o", fine}, 2, "what this command reads"},
        {{"rebuild", base, "-o", out}, 2, "--details: is needed"},
        {{"rebuild", base, "--details", fine, "-o", out}, 3, "holds no details of a mesh"},
        {{"rebuild", base, "--details", fine, "-o", in(folder, "out.npy")}, 3, "holds no details of a mesh"},
        {{"rebuild", base, "--details", in(folder, "damaged.details"), "-o", out}, 3, "is damaged"},
        {{"rebuild", base, "--details", in(folder, "cut.details"), "-o", out}, 3, "truncated"},
        {{"rebuild", car, "--details", details, "-o", out}, 3, "another connectivity"},
        {{"rebuild", in(folder, "moved.obj"), "--details", details, "-o", out}, 3, "--edited"},
        {{"rebuild", base, "--details", details, "--edited", fine, "-o", out}, 3, "another connectivity"},
        {{"rebuild", base, "--details", details, "--depth", "5", "-o", out}, 3, "holds details for 1 level"},
        {{"rebuild", base, "--details", details, "--frames", "local", "-o", out}, 2, "--edited"},
        {{"rebuild", base, "--details", details, "--keep", "1", "--threshold", "1", "-o", out},
         2,
         "one of them"},
        {{"subdivide", in(folder, "mixed.obj"), "-o", out}, 3, "mixed orientation"},
        {{"subdivide", torus, "--scheme", "loop", "-o", out}, 3, "triangle"},
        {{"subdivide", torus, "--depth", "99", "-o", out}, 2, "--depth"},
        {{"subdivide", torus, "-o", in(folder, "fine.obj/out.obj")}, 1, "cannot make this folder"},
    };
    for (const auto& each : cases) {
        const auto before = folder.snapshot();
        const auto result = isowave(each.arguments);
        EXPECT_EQ(result.exitCode, each.code) << each.says << ": " << result.err;
        EXPECT_THAT(result.err, HasSubstr(each.says));
        EXPECT_EQ(result.errorLines(), 1) << result.err;
        EXPECT_EQ(folder.snapshot(), before) << each.says;
    }
}

// Whatever is cut off or changed in an input, the answer is a mesh or one line.
TEST(MeshHierarchyCommands, SurviveDamagedFiles) {
    const Folder folder;
    succeed({"subdivide", kCages + "catmark_torus.obj", "--depth", "1", "-o", in(folder, "fine.ply")});
    succeed({"reverse", in(folder, "fine.ply"), "-o", in(folder, "base.obj"), "--details", in(folder, "d"),
             "--quiet"});
    for (const char* name : {"fine.ply", "d"}) {
        const std::string bytes = contentOf(folder / name);
        for (int part = 1; part < 10; ++part) {
            std::string cut = bytes.substr(0, bytes.size() * part / 10);
            const bool mesh = std::string(name) == "fine.ply";
            std::ofstream(folder / (mesh ? "cut.ply" : "cut"), std::ios::binary) << cut;
            const auto result = mesh ? isowave({"reverse", in(folder, "cut.ply"), "-o", in(folder, "x.obj")})
                                     : isowave({"rebuild", in(folder, "base.obj"), "--details",
                                                in(folder, "cut"), "-o", in(folder, "x.obj")});
            EXPECT_EQ(result.exitCode, 3) << name << part << result.err;
            EXPECT_EQ(result.errorLines(), 1) << result.err;
            EXPECT_FALSE(fs::exists(folder / "x.obj"));
        }
    }
}

TEST(Reverse, OnAFullDiskLeavesNothing) {
    const Folder folder;
    succeed({"subdivide", kCages + "catmark_rook.obj", "--depth", "1", "-o", in(folder, "fine.obj")});
    const auto before = folder.snapshot();
    RunOptions full;
    full.largestFile = 20'000;
    const auto result = isowave({"reverse", in(folder, "fine.obj"), "-o", in(folder, "base.obj"), "--depth",
                                 "1", "--details", in(folder, "d")},
                                full);
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_EQ(folder.snapshot(), before);
}

}  // namespace
}  // namespace isowave::tools_test
