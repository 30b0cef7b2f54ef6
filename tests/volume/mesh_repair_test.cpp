#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "isowave/error.h"
#include "volume/distance.h"
#include "volume/mesh_checks.h"
#include "volume/mesh_repair.h"

namespace isowave {
namespace {

using checks::box, checks::isClosedAndOriented, checks::reversed, checks::volumeOf;
using shapes::sphere, shapes::together;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct Repaired {
    TriangleMesh mesh;
    MeshRepairReport report;
};

Repaired repaired(TriangleMesh mesh, const RepairOptions& options = {}) {
    Repaired result;
    result.mesh = repairMesh(std::move(mesh), "part.stl", &result.report, options);
    return result;
}

// As STL has it: three points of its own for every triangle.
TriangleMesh split(const TriangleMesh& mesh) {
    TriangleMesh soup;
    for (const Triangle& t : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.points.size());
        for (const auto corner : t) soup.points.push_back(mesh.points[corner]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

TriangleMesh withFlips(TriangleMesh mesh, double fraction, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::size_t> order(mesh.triangles.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    order.resize(std::size_t(fraction * double(order.size())));
    for (const auto t : order) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    return mesh;
}

const TriangleMesh kBall = sphere(10, 3);  // 1,280 triangles

TEST(RepairMesh, LeavesAGoodMeshAlone) {
    const auto [mesh, report] = repaired(kBall);
    EXPECT_EQ(mesh.points.size(), kBall.points.size());
    EXPECT_EQ(mesh.triangles.size(), kBall.triangles.size());
    EXPECT_EQ(volumeOf(mesh), volumeOf(kBall));
    EXPECT_EQ(report.facesRead, 1280);
    EXPECT_TRUE(report.oriented);
    EXPECT_FALSE(report.evenOdd);
    EXPECT_THAT(report.notes, ::testing::IsEmpty());
}

TEST(RepairMesh, MergesSplitPoints) {
    const auto [mesh, report] = repaired(split(kBall));
    EXPECT_EQ(mesh.points.size(), kBall.points.size());
    EXPECT_EQ(report.pointsMerged, 3 * 1280 - 642);
    EXPECT_TRUE(isClosedAndOriented(mesh));
    TriangleMesh zeros = split(box({0, 0, 0}, {1, 1, 1}));
    for (std::size_t i = 0; i < zeros.points.size(); i += 2) {
        for (double& x : zeros.points[i]) x = x == 0 ? -0.0 : x;
    }
    EXPECT_EQ(repaired(zeros).mesh.points.size(), 8u);  // -0 is 0
}

TEST(RepairMesh, FillsTheHoleOfOneMissingTriangle) {
    TriangleMesh broken = kBall;
    broken.triangles.erase(broken.triangles.begin() + 100);
    EXPECT_FALSE(isClosedAndOriented(broken));
    const auto [mesh, report] = repaired(broken);
    EXPECT_TRUE(isClosedAndOriented(mesh));
    EXPECT_EQ(mesh.triangles.size(), 1280u);
    EXPECT_NEAR(volumeOf(mesh), volumeOf(kBall), 1e-9);
    EXPECT_EQ(report.boundaryEdges, 3);
    EXPECT_EQ(report.boundaryLoops, 1);
    EXPECT_EQ(report.holesFilled, 1);
    EXPECT_TRUE(report.oriented);
    EXPECT_THAT(report.notes, ::testing::ElementsAre("1 hole filled"));
}

TEST(RepairMesh, FillsManyHolesSomeOfWhichTouch) {
    TriangleMesh broken = kBall;
    std::mt19937 random(3);
    std::erase_if(broken.triangles, [&](const Triangle&) { return random() % 12 == 0; });
    const auto [mesh, report] = repaired(broken);
    EXPECT_TRUE(isClosedAndOriented(mesh));
    EXPECT_GT(report.holesFilled, 50);
    EXPECT_FALSE(report.evenOdd);
    EXPECT_NEAR(volumeOf(mesh), volumeOf(kBall), 0.01 * volumeOf(kBall));
}

TEST(RepairMesh, RefusesHalfASphereAndSaysWhy) {
    TriangleMesh half = kBall;
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return kBall.points[t[0]][2] + kBall.points[t[1]][2] + kBall.points[t[2]][2] < 0;
    });
    EXPECT_THAT(
        [&] { repaired(half); },
        ThrowsMessage<InputError>(AllOf(HasSubstr("part.stl: not closed: "), HasSubstr(" boundary edges in "),
                                        HasSubstr("up to 50 % are filled"), HasSubstr("mesh editor"))));
    EXPECT_TRUE(isClosedAndOriented(repaired(half, {.maxHole = 4}).mesh))
        << "with a larger limit it is filled";
}

// `count` triangles in a row: one boundary loop of count + 2 edges.
TriangleMesh ribbon(std::uint32_t count) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < count + 2; ++i) mesh.points.push_back({0.5 * i, double(i % 2), 0});
    for (std::uint32_t i = 0; i < count; ++i) mesh.triangles.push_back({i, i + 1 + i % 2, i + 2 - i % 2});
    return mesh;
}

// Loose triangles that share nothing but one point, which none of the others does; far from kBall.
TriangleMesh star(std::uint32_t count) {
    TriangleMesh mesh;
    mesh.points.push_back({20, 0, 0});
    for (std::uint32_t i = 0; i < count; ++i) {
        mesh.points.push_back({21, 1e-6 * i, 0});
        mesh.points.push_back({21, 1e-6 * i, 1});
        mesh.triangles.push_back({0, 2 * i + 1, 2 * i + 2});
    }
    return mesh;
}

// Were it quadratic in the boundary, each of the two would outlast any test's time limit.
TEST(RepairMesh, WalksABoundaryOfMillionsOfEdges) {
    EXPECT_THAT([] { repaired(ribbon(1'999'998)); },
                ThrowsMessage<InputError>(HasSubstr("2000000 boundary edges in 1 loop(s), 1 too long")));
}

TEST(RepairMesh, WalksHundredsOfThousandsOfLoopsThroughOnePoint) {
    const auto [mesh, report] = repaired(together(kBall, star(1'000'000)));
    EXPECT_EQ(report.boundaryLoops, 1'000'000);
    EXPECT_EQ(report.looseRemoved, 1'000'000);
    EXPECT_EQ(mesh.triangles.size(), kBall.triangles.size());
}

TEST(RepairMesh, StopsWhereverItIsAsked) {
    // Flipped and with holes, so that no pass is left out; 20,480 triangles, 61,440 edge uses.
    TriangleMesh mesh = withFlips(sphere(10, 5), 0.1, 1);
    for (int hole = 0; hole < 3; ++hole) mesh.triangles.erase(mesh.triangles.begin() + 5000 * hole);
    int asked = 0, reported = 0;
    double last = 0;
    Progress progress;
    progress.stopRequested = [&] { return ++asked, false; };
    progress.report = [&](std::string_view, double done) {
        ++reported;
        EXPECT_GE(done, last);
        last = done;
    };
    repairMesh(mesh, "part.stl", nullptr, {}, progress);
    EXPECT_GT(reported, 5);
    EXPECT_EQ(last, 1);
    const int questions = asked;
    ASSERT_GT(questions, reported + 10) << "inside the passes, too";
    for (int after = 0; after < questions; ++after) {
        asked = 0;
        progress.report = {};
        progress.stopRequested = [&] { return ++asked > after; };
        EXPECT_THROW(repairMesh(mesh, "part.stl", nullptr, {}, progress), Cancelled) << after;
    }
}

TEST(RepairMesh, FillsAsFarAsItsOptionAllows) {
    TriangleMesh broken = kBall;
    broken.triangles.pop_back();
    EXPECT_NO_THROW(repaired(broken));
    EXPECT_THROW(repaired(broken, {.maxHole = 0}), InputError);
    EXPECT_NO_THROW(repaired(kBall, {.maxHole = 0}));
}

TEST(RepairMesh, TurnsFlippedFaces) {
    const auto [mesh, report] = repaired(withFlips(kBall, 0.1, 1));
    EXPECT_EQ(report.facesFlipped, 128);
    EXPECT_FALSE(report.oriented);
    EXPECT_FALSE(report.evenOdd);
    EXPECT_TRUE(isClosedAndOriented(mesh));
    EXPECT_NEAR(volumeOf(mesh), volumeOf(kBall), 1e-9);  // outside is where the majority had it
}

TEST(RepairMesh, SaysWhenOrientationCannotBeTrusted) {
    // Two parts at random: neither tells which side it means. Counting crossings still does.
    const TriangleMesh parts = together(sphere(10, 3), sphere(5, 3));
    const auto random = repaired(withFlips(parts, 0.5, 2));
    EXPECT_TRUE(random.report.evenOdd);
    EXPECT_TRUE(isClosedAndOriented(random.mesh));
    EXPECT_THAT(random.report.notes, ::testing::Contains(HasSubstr("orientation cannot be trusted")));
    EXPECT_FALSE(repaired(withFlips(parts, 0.05, 2)).report.evenOdd);
    EXPECT_FALSE(repaired(withFlips(kBall, 0.5, 2)).report.evenOdd)
        << "one part has one inside either way round";
}

TEST(RepairMesh, DropsDegenerateAndDuplicateTriangles) {
    TriangleMesh broken = kBall;
    const Triangle t = broken.triangles[5];
    broken.triangles.push_back(t);
    broken.triangles.push_back({t[1], t[2], t[0]});
    broken.triangles.push_back({t[1], t[1], t[0]});
    const auto [mesh, report] = repaired(broken);
    EXPECT_EQ(report.duplicatesRemoved, 2);
    EXPECT_EQ(report.degenerateRemoved, 1);
    EXPECT_EQ(mesh.triangles.size(), 1280u);
    EXPECT_TRUE(isClosedAndOriented(mesh));
}

TEST(RepairMesh, TakesASurfaceListedFromBothSidesOnce) {
    const TriangleMesh twice = together(kBall, reversed(kBall));
    const auto [mesh, report] = repaired(twice);
    EXPECT_EQ(report.duplicatesRemoved, 1280);
    EXPECT_EQ(mesh.triangles.size(), 1280u);
    EXPECT_EQ(volumeOf(mesh), volumeOf(kBall));
}

TEST(RepairMesh, DropsAFinFoldedOntoItself) {
    TriangleMesh broken = kBall;
    const Triangle t = broken.triangles[5];
    const auto tip = static_cast<std::uint32_t>(broken.points.size());
    broken.points.push_back({0, 0, 20});
    broken.triangles.push_back({t[0], t[1], tip});
    broken.triangles.push_back({t[1], t[0], tip});
    const auto [mesh, report] = repaired(broken);
    EXPECT_EQ(report.duplicatesRemoved, 2);
    EXPECT_EQ(mesh.points.size(), kBall.points.size() + 1);
    EXPECT_EQ(mesh.triangles.size(), 1280u);
    EXPECT_TRUE(isClosedAndOriented(mesh));
}

TEST(RepairMesh, DropsLooseTriangles) {
    TriangleMesh broken = kBall;
    const auto first = static_cast<std::uint32_t>(broken.points.size());
    broken.points.insert(broken.points.end(), {{0, 0, 12}, {1, 0, 12}, {0, 1, 12}});
    broken.triangles.push_back({first, first + 1, first + 2});
    const auto [mesh, report] = repaired(broken);
    EXPECT_EQ(report.looseRemoved, 1);
    EXPECT_EQ(report.holesFilled, 0);
    EXPECT_EQ(mesh.triangles.size(), 1280u);
}

TEST(RepairMesh, RefusesWhereAllWasLoose) {
    EXPECT_THAT(
        [] { repaired(star(100), {.maxHole = 9}); },
        ThrowsMessage<InputError>(HasSubstr("no triangles are left of 100: 0 degenerate, 0 duplicates, "
                                            "100 loose")));
}

TEST(RepairMesh, KeepsEdgesWithFourTriangles) {
    // Two boxes that touch along an edge.
    const auto [mesh, report] =
        repaired(split(together(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {2, 2, 1}))));
    EXPECT_EQ(report.nonManifoldEdges, 1);
    EXPECT_EQ(mesh.points.size(), 14u);
    EXPECT_FALSE(report.evenOdd);
    const auto grid = distanceFromMesh(mesh, *transformForMesh(mesh, 0.1), 3.0);
    EXPECT_LT(grid->tree().getValue(openvdb::Coord(5, 5, 5)), 0);
    EXPECT_LT(grid->tree().getValue(openvdb::Coord(15, 15, 5)), 0);
    EXPECT_GT(grid->tree().getValue(openvdb::Coord(15, 5, 5)), 0);
}

TEST(RepairMesh, ClosesASurfaceThatHasNoSides) {
    // A Moebius strip is no solid's boundary. Closed modulo 2 it is one for counting crossings.
    TriangleMesh strip;
    const int n = 60;
    for (int i = 0; i < n; ++i) {
        const double u = 2 * M_PI * i / n;
        for (const double w : {-0.05, 0.05}) {
            const double r = 1 + w * std::cos(u / 2);
            strip.points.push_back({r * std::cos(u), r * std::sin(u), w * std::sin(u / 2)});
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = 2 * i, b = a + 1, c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;
        strip.triangles.push_back({a, b, c});
        strip.triangles.push_back({b, d, c});
    }
    EXPECT_THROW(repaired(strip), InputError);
    const auto [mesh, report] = repaired(strip, {.maxHole = 10});
    EXPECT_FALSE(report.oriented);
    EXPECT_TRUE(report.evenOdd);
    EXPECT_NO_THROW(distanceFromMesh(mesh, *transformForMesh(mesh, 0.05), 2.0, true));
}

TEST(RepairMesh, RefusesWhatHasNothingLeft) {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}};
    mesh.triangles = {{0, 1, 1}, {0, 0, 1}};
    EXPECT_THAT([&] { repaired(mesh); }, ThrowsMessage<InputError>(HasSubstr("no triangles are left of 2")));
    EXPECT_THROW(repaired({}), InputError);
}

TEST(RepairMesh, MakesEveryBrokenBallAClosedSolid) {
    // All defects at once, of any seed: what comes out is accepted by the sign's own check of closedness.
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937 random(seed);
        TriangleMesh broken = split(withFlips(together(sphere(10, 3), sphere(6, 2, {15, 3, 2})), 0.08, seed));
        std::erase_if(broken.triangles, [&](const Triangle&) { return random() % 40 == 0; });
        for (int i = 0; i < 20; ++i)
            broken.triangles.push_back(broken.triangles[random() % broken.triangles.size()]);
        std::shuffle(broken.triangles.begin(), broken.triangles.end(), random);
        const auto [mesh, report] = repaired(broken);
        EXPECT_FALSE(report.evenOdd) << seed;
        EXPECT_TRUE(isClosedAndOriented(mesh)) << seed;
        const auto grid = distanceFromMesh(mesh, *transformForMesh(mesh, 0.5), 3.0, report.evenOdd);
        EXPECT_LT(grid->tree().getValue(openvdb::Coord::round(grid->transform().worldToIndex({0, 0, 0}))), 0);
        EXPECT_GT(grid->tree().getValue(openvdb::Coord::round(grid->transform().worldToIndex({9, 9, 9}))), 0);
    }
}

}  // namespace
}  // namespace isowave
