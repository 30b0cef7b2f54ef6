// What only simplify/ can count: pairs of triangles that intersect, and distances.
#include "polygonize/quadric_collapse.h"

#include <gtest/gtest.h>

#include <random>

#include "base/triangle.h"
#include "polygonize/collapse/apart.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "simplify/collapse.h"
#include "simplify/distance.h"
#include "simplify/self_intersections.h"
#include "simplify/shapes.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

std::int64_t trianglesOf(const TriangleMesh& mesh) {
    return static_cast<std::int64_t>(mesh.triangles.size());
}

// A ball with a concentric hole: a wall `thickness` thick.
TriangleMesh shell(int level, double thickness) {
    TriangleMesh inner = shapes::sphere(1 - thickness, level);
    for (Triangle& t : inner.triangles) std::swap(t[1], t[2]);
    return shapes::together(shapes::sphere(1, level, {0, 0, 0}), inner);
}

TEST(QuadricCollapse, MakesNoPairOfIntersectingTriangles) {
    for (const auto& [name, field] : zoo::allFields()) {
        PolygonizeOptions refined;
        refined.refine = 2;
        TriangleMesh mesh = polygonize(field, refined);
        const std::int64_t before = countSelfIntersections(mesh);
        CollapseOptions options;
        options.triangles = trianglesOf(mesh) / 4;
        collapseByQuadrics(mesh, options);
        EXPECT_LE(countSelfIntersections(mesh), before) << name;
    }
}

// Walls down to a fiftieth of the edges that are to be left: other sheets refuse most of what the quadrics want there.
TEST(QuadricCollapse, KeepsTheSheetsOfThinWallsApart) {
    bool refused = false;
    for (const double thickness : {0.1, 0.02, 0.005, 0.002}) {
        TriangleMesh mesh = shell(5, thickness);  // edges of 0.04; their middles lie 0.0002 deep
        ASSERT_EQ(countSelfIntersections(mesh), 0);
        CollapseOptions options;
        options.triangles = trianglesOf(mesh) / 8;
        CollapseReport report;
        collapseByQuadrics(mesh, options, &report);
        EXPECT_EQ(countSelfIntersections(mesh), 0) << thickness;
        EXPECT_EQ(topologyOf(mesh).components, 2);
        refused = refused || report.refusedSheets > 100;
    }
    EXPECT_TRUE(refused);  // else nothing was tried
    // The collapse that does not look at other sheets makes some.
    const TriangleMesh thin = shell(5, 0.002);
    EXPECT_GT(countSelfIntersections(decimate(thin, trianglesOf(thin) / 8)), 0);
}

TEST(QuadricCollapse, IsAboutAsNearAsTheCollapseByLindstromAndTurk) {
    int compared = 0;
    for (const auto& [name, field] : zoo::allFields()) {
        if (name != "sphere, distance" && name != "torus, distance") continue;
        ++compared;
        PolygonizeOptions refined;
        refined.refine = 2;
        const TriangleMesh mesh = polygonize(field, refined);
        CollapseOptions options;
        options.triangles = trianglesOf(mesh) / 4;
        TriangleMesh fewer = mesh;
        collapseByQuadrics(fewer, options);
        const MeshComparison ours = compareMeshes(mesh, fewer),
                             theirs = compareMeshes(mesh, decimate(mesh, options.triangles));
        EXPECT_LT(ours.rms, 1.3 * theirs.rms) << name;  // seen 1.1
        EXPECT_LT(ours.max, 2.5 * theirs.max) << name;  // seen 1.9; 0.6 to 0.8 on levels of real parts
    }
    EXPECT_EQ(compared, 2);
}

// ---- triangles that are apart

// In a cube; or, flat, within one tilted plane. Multiples of 1/64, so that these points are in the plane exactly.
Vec3 randomPoint(std::mt19937& random, bool flat) {
    std::uniform_int_distribution<int> place(-64, 64);
    const Vec3 p = Vec3{1.0 * place(random), 1.0 * place(random), 1.0 * place(random)} / 64;
    return flat ? Vec3{p.x, p.y, 0.25 * p.x - 0.5 * p.y} : p;
}

bool meet(const std::vector<Vec3>& corners, const Triangle& t, const Triangle& u) {
    TriangleMesh mesh;
    for (const Vec3& p : corners) mesh.points.push_back({p.x, p.y, p.z});
    mesh.triangles = {t, u};
    return countSelfIntersections(mesh) > 0;
}

TEST(Apart, AgreesWithTheExactPredicatesOnRandomTriangles) {
    std::mt19937 random(7);
    int apart = 0, differ = 0;
    for (int i = 0; i < 4000; ++i) {
        std::vector<Vec3> p(6);
        for (Vec3& x : p) x = randomPoint(random, i % 4 == 0);
        if (cross(p[1] - p[0], p[2] - p[0]) == Vec3{} || cross(p[4] - p[3], p[5] - p[3]) == Vec3{}) continue;
        const bool says = triangleIsApart({p[0], p[1], p[2]}, {p[3], p[4], p[5]});
        const bool meets = meet(p, {0, 1, 2}, {3, 4, 5});
        EXPECT_FALSE(says && meets) << i;
        apart += says ? 1 : 0;
        differ += says == meets ? 1 : 0;
    }
    EXPECT_GT(apart, 1000);
    EXPECT_EQ(differ, 0);
}

TEST(Apart, AgreesWithTheExactPredicatesOnTrianglesOverACorner) {
    std::mt19937 random(8);
    int apart = 0, differ = 0;
    for (int i = 0; i < 4000; ++i) {
        std::vector<Vec3> p(5);
        for (Vec3& x : p) x = randomPoint(random, i % 4 == 0);
        const bool says = triangleIsApartAtCorner(p[1] - p[0], p[2] - p[0], p[3] - p[0], p[4] - p[0]);
        const bool meets = meet(p, {0, 1, 2}, {0, 3, 4});
        EXPECT_FALSE(says && meets) << i;
        apart += says ? 1 : 0;
        differ += says == meets ? 1 : 0;
    }
    EXPECT_GT(apart, 1000);
    EXPECT_LT(differ, 100);  // in one plane not every pair is told apart
}

TEST(Apart, TouchingIsNotApart) {
    const std::array<Vec3, 3> base{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
    EXPECT_FALSE(triangleIsApart(base, {{{1, 1, 0}, {1, 1, 1}, {1, 2, 1}}}));
    EXPECT_TRUE(triangleIsApart(base, {{{1, 1, 1e-9}, {1, 1, 1}, {1, 2, 1}}}));
    EXPECT_FALSE(triangleIsApart(base, {{{1, 1, 1e-14}, {1, 1, 1}, {1, 2, 1}}}));  // too near to tell
    EXPECT_TRUE(triangleIsUnfolded({0, 0, 1}, {0, 1, -1}));
    EXPECT_FALSE(triangleIsUnfolded({0, 0, 1}, {0, 0.01, -1}));
}

}  // namespace
}  // namespace isowave
