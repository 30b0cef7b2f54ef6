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

TEST(RepairMesh, LeavesOutPointsInNoTriangle) {
    TriangleMesh more = kBall;
    more.points.push_back({99, 99, 99});
    const auto [mesh, report] = repaired(more);
    EXPECT_EQ(mesh.points.size(), kBall.points.size());
    EXPECT_THAT(report.notes, ::testing::ElementsAre("1 point in no triangle left out"));
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
    EXPECT_THAT(report.notes, ::testing::ElementsAre(HasSubstr("1 hole filled, ")));
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
    EXPECT_THAT([&] { repaired(half); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("part.stl: not closed: "),
                                                HasSubstr(" boundary edges in "), HasSubstr(" wide and "),
                                                HasSubstr("--close-holes 20 "), HasSubstr("--thicken T"))));
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
                ThrowsMessage<InputError>(HasSubstr("2,000,000 boundary edges in 1 loop, 1 too large")));
}

TEST(RepairMesh, WalksHundredsOfThousandsOfLoopsThroughOnePoint) {
    // They are nearly all of the area, so they are refused and not dropped.
    EXPECT_THAT(
        [] { repaired(together(kBall, star(1'000'000))); },
        ThrowsMessage<InputError>(HasSubstr("1,000,000 triangles share no edge with another one, 100 %")));
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

// A closed box of many triangles, low to high, whose corners of one place differ by up to `jitter` on each axis, drawn anew
// for each corner of each triangle, as a CAD system writes it whose faces know nothing of each other.
TriangleMesh jittered(const TriangleMesh& mesh, double jitter, unsigned seed) {
    TriangleMesh soup = split(mesh);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(-jitter / 2, jitter / 2);
    for (Point& p : soup.points)
        for (double& x : p) x += draw(random);
    return soup;
}

TEST(RepairMesh, WeldsCornersThatDifferInTheirLastDigits) {
    const TriangleMesh ball = sphere(10, 3), parts = together(ball, box({20, 0, 0}, {25, 5, 5}));
    for (const double jitter : {1e-9, 1e-6, 1e-5, 5e-5}) {
        const auto [mesh, report] = repaired(jittered(parts, jitter, 5));
        EXPECT_TRUE(isClosedAndOriented(mesh)) << jitter;
        EXPECT_EQ(mesh.triangles.size(), parts.triangles.size()) << jitter;
        EXPECT_NEAR(volumeOf(mesh), volumeOf(parts), 1e3 * jitter) << jitter;
        EXPECT_GT(report.pointsWelded, 3000) << jitter;
        EXPECT_LE(report.weldedFarthest, 2 * jitter) << jitter;
        EXPECT_EQ(report.looseRemoved, 0);
        EXPECT_THAT(report.notes,
                    ::testing::Contains(HasSubstr("points on cracks moved onto their neighbours")));
    }
    EXPECT_EQ(repaired(parts).report.pointsWelded, 0);
}

TEST(RepairMesh, WeldsOnlyWhatIsOpen) {
    // A closed box of 1e-6, far below any tolerance of the weld, beside a ball whose corners differ by 1e-5.
    const TriangleMesh small = box({20, 0, 0}, {20 + 1e-6, 1e-6, 1e-6});
    const auto [mesh, report] = repaired(together(jittered(kBall, 1e-5, 2), small));
    EXPECT_EQ(mesh.triangles.size(), 1280u + 12);
    EXPECT_TRUE(isClosedAndOriented(mesh));
}

TEST(RepairMesh, WeldsTheSameWhateverTheOrderOfTriangles) {
    TriangleMesh soup = jittered(kBall, 1e-5, 3);
    const auto pointsOf = [](const TriangleMesh& m) {
        std::vector<Point> points = m.points, used;
        for (const Triangle& t : m.triangles)
            for (const auto corner : t) used.push_back(points[corner]);
        std::sort(used.begin(), used.end());
        return used;
    };
    const auto before = pointsOf(repaired(soup).mesh);
    std::mt19937 random(4);
    std::shuffle(soup.triangles.begin(), soup.triangles.end(), random);
    EXPECT_EQ(pointsOf(repaired(soup).mesh), before);
}

TEST(RepairMesh, RefusesToLoseAPartWhoseCornersLieFarApart) {
    EXPECT_THAT(
        [] {
            repaired(together(box({0, 0, 0}, {20, 20, 20}), jittered(sphere(5, 2, {10, 10, 30}), 0.1, 1)));
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("320 triangles share no edge with another one"),
                                        HasSubstr("merge points by distance"))));
}

// A bar of 100 x 20 x 20 whose top and bottom are single quads and whose sides are cut into `pieces`.
TriangleMesh barWithTJunctions(std::uint32_t pieces, double off = 0) {
    TriangleMesh bar;
    const auto quad = [&](const Point& a, const Point& b, const Point& c, const Point& d) {
        const auto first = static_cast<std::uint32_t>(bar.points.size());
        bar.points.insert(bar.points.end(), {a, b, c, d});
        bar.triangles.push_back({first, first + 1, first + 2});
        bar.triangles.push_back({first, first + 2, first + 3});
    };
    quad({0, 0, 0}, {0, 20, 0}, {100, 20, 0}, {100, 0, 0});
    quad({0, 0, 20}, {100, 0, 20}, {100, 20, 20}, {0, 20, 20});
    quad({0, 0, 0}, {0, 0, 20}, {0, 20, 20}, {0, 20, 0});
    quad({100, 0, 0}, {100, 20, 0}, {100, 20, 20}, {100, 0, 20});
    for (std::uint32_t i = 0; i < pieces; ++i) {
        const double x = 100.0 * i / pieces, z = 100.0 * (i + 1) / pieces, y = i > 0 ? off : 0,
                     w = i + 1 < pieces ? off : 0;
        quad({x, y, 0}, {z, w, 0}, {z, w, 20}, {x, y, 20});
        quad({x, 20, 0}, {x, 20, 20}, {z, 20, 20}, {z, 20, 0});
    }
    return bar;
}

TEST(RepairMesh, ClosesTJunctions) {
    for (const std::uint32_t pieces : {2u, 3u, 5u, 40u, 1000u}) {
        const auto [mesh, report] = repaired(barWithTJunctions(pieces));
        EXPECT_TRUE(isClosedAndOriented(mesh)) << pieces;
        EXPECT_NEAR(volumeOf(mesh), 40000, 1e-6) << pieces;
        EXPECT_EQ(report.edgesSplit, 4) << pieces;
        EXPECT_EQ(report.holesFilled, 0) << pieces;
    }
    EXPECT_TRUE(isClosedAndOriented(repaired(barWithTJunctions(7, 1e-4)).mesh)) << "a little off the edge";
}

TEST(RepairMesh, FillsALongCrackThatIsNarrow) {
    // Wider than any tolerance: 0.5 of 100. The crack's two loops are 100 long, more than half the diagonal.
    const auto [mesh, report] = repaired(barWithTJunctions(5, 0.5));
    EXPECT_TRUE(isClosedAndOriented(mesh));
    EXPECT_EQ(report.holesFilled, 2);
    EXPECT_NEAR(report.widestFilled, 0.5, 0.3);
    EXPECT_NEAR(volumeOf(mesh), 40000, 1000);
}

TEST(RepairMesh, ClosesHolesUpToTheWidthThatIsAskedFor) {
    TriangleMesh noLid = box({0, 0, 0}, {10, 10, 10});
    std::erase_if(noLid.triangles, [](const Triangle& t) { return t[0] >= 4 && t[1] >= 4 && t[2] >= 4; });
    ASSERT_EQ(noLid.triangles.size(), 10u);
    EXPECT_THAT([&] { repaired(noLid); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("4 boundary edges in 1 loop"),
                                                HasSubstr("is 10 wide"), HasSubstr("--close-holes 10 "))));
    EXPECT_THROW(repaired(noLid, {.closeHoles = 9.9}), InputError);
    const auto [mesh, report] = repaired(noLid, {.closeHoles = 10});
    EXPECT_NEAR(volumeOf(mesh), 1000, 1e-9);
    EXPECT_NEAR(report.widestFilled, 10, 1e-9);
    RepairOptions open;
    open.mayStayOpen = true;
    EXPECT_EQ(repaired(noLid, open).mesh.triangles.size(), 10u);
}

TEST(RepairMesh, TurnsABodyThatIsInsideOutAndNoCavity) {
    const TriangleMesh a = box({0, 0, 0}, {10, 10, 10}), b = box({7, 1, 1}, {15, 9, 9});
    const auto volumeByWinding = [](const Repaired& r) {
        const auto grid = distanceFromMesh(r.mesh, *transformForMesh(r.mesh, 0.25), 3.0, r.report.evenOdd);
        std::int64_t inside = 0;
        const auto at = grid->getConstAccessor();
        for (int x = -4; x < 70; ++x)
            for (int y = -4; y < 50; ++y)
                for (int z = -4; z < 50; ++z) inside += at.getValue(openvdb::Coord(x, y, z)) < 0;
        return static_cast<double>(inside) / 64;
    };
    const double both = volumeByWinding(repaired(together(a, b)));
    EXPECT_NEAR(both, 1000 + 512 - 3 * 64, 40);
    for (const auto& [parts, turned] :
         {std::pair{together(a, reversed(b)), 1}, std::pair{together(reversed(a), b), 1},
          std::pair{together(reversed(a), reversed(b)), 2}}) {
        const Repaired r = repaired(parts);
        EXPECT_EQ(r.report.bodiesTurned, turned);
        EXPECT_EQ(volumeByWinding(r), both);
        EXPECT_THAT(r.report.notes, ::testing::Contains(HasSubstr("inside out: turned")));
    }
}

TEST(RepairMesh, KeepsCavitiesAlsoOfABodyThatIsInsideOut) {
    const TriangleMesh outer = sphere(10, 3), inner = sphere(5, 3), innermost = sphere(2, 3);
    const double hollow = volumeOf(outer) - volumeOf(inner);
    const TriangleMesh right = together(outer, reversed(inner));
    EXPECT_EQ(repaired(right).report.bodiesTurned, 0);
    EXPECT_NEAR(volumeOf(repaired(right).mesh), hollow, 1e-9);
    const auto mirrored = repaired(reversed(right));
    EXPECT_EQ(mirrored.report.bodiesTurned, 2);
    EXPECT_NEAR(volumeOf(mirrored.mesh), hollow, 1e-9);
    const auto core = repaired(together(right, innermost));
    EXPECT_EQ(core.report.bodiesTurned, 0);
    EXPECT_NEAR(volumeOf(core.mesh), hollow + volumeOf(innermost), 1e-9);
    const auto solid = repaired(together(outer, inner));
    EXPECT_EQ(solid.report.nestedSolid, 1);
    EXPECT_THAT(solid.report.notes, ::testing::ElementsAre(HasSubstr("faces the same way: solid")));
    // In the union of two that overlap, in neither alone.
    const TriangleMesh two = together(box({0, 0, 0}, {6, 10, 10}), box({4, 0, 0}, {10, 10, 10}));
    EXPECT_EQ(repaired(together(two, reversed(box({2, 3, 3}, {8, 7, 7})))).report.bodiesTurned, 0);
}

TEST(RepairMesh, StaysBalancedWithoutItsDuplicates) {
    // Two boxes that share a wall, triangle for triangle: the wall bounds nothing, the rest is one box.
    const TriangleMesh a = box({0, 0, 0}, {1, 1, 1}), b = box({1, 0, 0}, {2, 1, 1});
    const TriangleMesh both = together(a, b);
    const auto walled = repaired(both);
    EXPECT_TRUE(isClosedAndOriented(walled.mesh));
    EXPECT_FALSE(walled.report.evenOdd);
    EXPECT_NEAR(volumeOf(walled.mesh), 2, 1e-12);
    // Three of a triangle, two one way: what is left is the one that keeps the ball closed, whichever comes first.
    for (const bool otherFirst : {false, true}) {
        TriangleMesh triple = kBall;
        const Triangle t = triple.triangles[5];
        triple.triangles.insert(otherFirst ? triple.triangles.begin() : triple.triangles.end(),
                                {t[1], t[0], t[2]});
        triple.triangles.push_back(t);
        const auto [mesh, report] = repaired(triple);
        EXPECT_TRUE(isClosedAndOriented(mesh));
        EXPECT_EQ(report.facesFlipped, 0);
        EXPECT_NEAR(volumeOf(mesh), volumeOf(kBall), 1e-9);
    }
    // Twice the same triangle, both needed: bodies that touch in it from the same side, as boolean unions leave them.
    const TriangleMesh up = box({0, 0, 0}, {1, 1, 1});
    TriangleMesh twice = together(up, up);
    const auto doubled = repaired(twice);
    EXPECT_TRUE(isClosedAndOriented(doubled.mesh));
    EXPECT_NEAR(volumeOf(doubled.mesh), 1, 1e-12);
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
