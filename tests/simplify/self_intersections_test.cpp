#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>

#include "simplify/self_intersections.h"
#include "simplify/shapes.h"

namespace isowave {
namespace {

using namespace shapes;

TriangleMesh twoTriangles(std::vector<Point> points, const Triangle& t, const Triangle& u) {
    TriangleMesh mesh;
    mesh.points = std::move(points);
    mesh.triangles = {t, u};
    return mesh;
}

TEST(SelfIntersections, ACleanMeshHasNone) {
    EXPECT_EQ(countSelfIntersections(tetrahedron(1)), 0);
    EXPECT_EQ(countSelfIntersections(sphere(1, 4)), 0);
    EXPECT_EQ(countSelfIntersections(together(tetrahedron(1), tetrahedron(1, {2, 0, 0}))), 0);
    EXPECT_EQ(countSelfIntersections(TriangleMesh{}), 0);
}

TEST(SelfIntersections, CrossingTetrahedraHaveSome) {
    EXPECT_GT(countSelfIntersections(together(tetrahedron(1), tetrahedron(1, {0.2, 0.2, 0.2}))), 0);
}

TEST(SelfIntersections, AVertexPulledThroughTheOtherSideIsSeen) {
    TriangleMesh mesh = sphere(1, 3);
    ASSERT_EQ(countSelfIntersections(mesh), 0);
    mesh.points[0] = -1.5 * mesh.points[0];
    EXPECT_GT(countSelfIntersections(mesh), 0);
}

TEST(SelfIntersections, TrianglesWithoutASharedCorner) {
    const std::vector<Point> base = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto with = [&](const Point& p, const Point& q, const Point& r) {
        return countSelfIntersections(
            twoTriangles({base[0], base[1], base[2], p, q, r}, {0, 1, 2}, {3, 4, 5}));
    };
    EXPECT_EQ(with({1, 1, -1}, {1, 1, 1}, {1, 2, 1}), 1);      // pierced
    EXPECT_EQ(with({1, 1, 1e-300}, {1, 1, 1}, {1, 2, 1}), 0);  // a hair above: predicates are exact
    EXPECT_EQ(with({1, 1, 0}, {1, 1, 1}, {1, 2, 1}), 1);       // touched
    EXPECT_EQ(with({0, 0, 0}, {-1, 0, 1}, {0, -1, 1}), 1);     // equal corners that are not shared by index
    EXPECT_EQ(with({1, 1, 0}, {9, 1, 0}, {1, 9, 0}), 1);       // overlapping in one plane
}

TEST(SelfIntersections, TrianglesOverOneCorner) {
    const std::vector<Point> base = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto with = [&](const Point& p, const Point& q) {
        return countSelfIntersections(twoTriangles({base[0], base[1], base[2], p, q}, {0, 1, 2}, {3, 0, 4}));
    };
    EXPECT_EQ(with({-1, 0, 1}, {0, -1, 1}), 0);
    EXPECT_EQ(with({2, 1, 1}, {2, 1, -1}), 1);  // its far side pierces the first triangle
    EXPECT_EQ(with({9, 9, 1}, {9, 9, -1}), 1);  // the first triangle's far side pierces it
}

TEST(SelfIntersections, TrianglesOverOneEdge) {
    const auto with = [](const Point& p) {
        return countSelfIntersections(
            twoTriangles({{0, 0, 0}, {4, 0, 0}, {1, 4, 0}, p}, {0, 1, 2}, {1, 0, 3}));
    };
    EXPECT_EQ(with({1, -4, 0}), 0);      // flat
    EXPECT_EQ(with({1, 4, 1e-300}), 0);  // nearly folded over
    EXPECT_EQ(with({2, 1, 0}), 1);       // folded over
}

TEST(SelfIntersections, TheSameTriangleTwiceIsAPair) {
    EXPECT_EQ(countSelfIntersections(twoTriangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2}, {2, 1, 0})),
              1);
}

TEST(SelfIntersections, TrianglesOnALineAreLeftOut) {
    EXPECT_EQ(countSelfIntersections(twoTriangles({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}},
                                                  {0, 1, 2}, {3, 4, 4})),
              0);
}

TEST(SelfIntersections, CountDependsNeitherOnThreadsNorOnTheOrderOfTriangles) {
    TriangleMesh mesh = together(sphere(1, 5), sphere(1, 5, {0.3, 0.2, 0.1}));
    std::vector<std::int64_t> counts;
    for (const int threads : {1, 2, 4}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        counts.push_back(countSelfIntersections(mesh));
        std::shuffle(mesh.triangles.begin(), mesh.triangles.end(),
                     std::mt19937(static_cast<unsigned>(threads)));
    }
    EXPECT_GT(counts[0], 100);
    EXPECT_EQ(counts[1], counts[0]);
    EXPECT_EQ(counts[2], counts[0]);
}

TEST(SelfIntersections, StopsWhenAsked) {
    std::atomic<int> asked = 0;
    Progress progress;
    progress.stopRequested = [&] { return ++asked > 1; };
    EXPECT_THROW(countSelfIntersections(sphere(1, 5), progress), Cancelled);
}

}  // namespace
}  // namespace isowave
