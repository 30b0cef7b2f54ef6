#include "polygonize/zero_set.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "polygonize/relax.h"
#include "polygonize/topology.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using namespace isowave::testing;

Vec3d toVec(const Point& p) { return {p[0], p[1], p[2]}; }

TEST(ZeroSet, FootOfAPointIsWhereTheSphereIs) {
    const BSplineField field = fieldFromDistance(14, sphere(9));
    const ZeroSet surface(field);
    for (const Vec3d& direction : {Vec3d(1, 0, 0), Vec3d(1, 2, 3), Vec3d(-1, 1, -0.2)}) {
        const Vec3d out = direction.unit(), centre(0.31, -0.17, 0.23);
        for (const double off : {-0.5, 0.0, 0.5}) {
            const auto foot = surface.foot(centre + (9 + off) * out);
            ASSERT_TRUE(foot);
            EXPECT_LT((foot->at - (centre + 9 * out)).length(), 0.01);
            EXPECT_GT(foot->normal.dot(out), 0.999);
            EXPECT_LT(std::abs(evaluate(field, foot->at)), 1e-8);
        }
        EXPECT_FALSE(surface.foot(centre + 12 * out));  // beyond its reach
    }
}

TEST(ZeroSet, NormalsOfAMeshAreThoseOfItsPointsFeet) {
    const BSplineField field = fieldFromDistance(14, sphere(9), oblique());
    const ZeroSet surface(field);
    TriangleMesh mesh = polygonize(field);
    const auto normals = surface.normalsOf(mesh);
    ASSERT_EQ(normals.size(), mesh.points.size());
    for (std::size_t i = 0; i < normals.size(); ++i)
        for (int a = 0; a < 3; ++a) ASSERT_NEAR(normals[i][a], mesh.normals[i][a], 1e-3);
    // Far from the surface: the triangles' own.
    for (Point& p : mesh.points) p[0] += 1000;
    for (const auto& n : surface.normalsOf(mesh))
        EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-5);
}

// A triangle with sides of a voxel sags by about h^2 / (8 r) from a sphere: half for h/2.
TEST(Deviation, OfASphereIsTheSagOfItsTrianglesAndFallsFourfoldWithRefine) {
    for (const auto& transform : {openvdb::math::Transform::createLinearTransform(1), oblique()}) {
        const BSplineField field = fieldFromDistance(14, sphere(9), transform);
        const ZeroSet surface(field);
        double before = 0;
        for (const int refine : {1, 2, 4}) {
            const Deviation d = deviationFrom(surface, polygonize(field, {.refine = refine}));
            EXPECT_GT(d.max, d.rms);
            if (refine > 1) {
                EXPECT_GT(before / d.rms, 3.5) << refine;
                EXPECT_LT(before / d.rms, 4.5) << refine;
            }
            before = d.rms;
            // sides up to sqrt(2) voxels, the longest diagonal sqrt(3): 3 / (8 * 9)
            EXPECT_LT(d.max, surface.voxel() * 3 / 72.0 * 3 / (refine * refine)) << refine;
        }
    }
}

TEST(Deviation, SeesAVertexThatLeftTheSurface) {
    const BSplineField field = fieldFromDistance(14, sphere(9));
    TriangleMesh mesh = polygonize(field);
    const double before = deviationFrom(ZeroSet(field), mesh).max;
    for (double& x : mesh.points[10]) x *= 1.05;
    EXPECT_GT(deviationFrom(ZeroSet(field), mesh).max, before + 0.1);
}

TEST(Deviation, IsFiniteForNoiseAndTheSameForAnyNumberOfThreads) {
    const BSplineField field = noiseField(16, 4);
    const TriangleMesh mesh = polygonize(field);
    std::vector<Deviation> results;
    for (const int threads : {1, 2, 4}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        results.push_back(deviationFrom(ZeroSet(field), mesh));
    }
    for (const Deviation& d : results) {
        EXPECT_EQ(d.max, results[0].max);
        EXPECT_EQ(d.rms, results[0].rms);
        EXPECT_LT(d.max, 1);
    }
    EXPECT_EQ(deviationFrom(ZeroSet(field), {}).max, 0);
}

TEST(Relax, RaisesTheSmallestAngleAndStaysOnTheZeroSet) {
    for (const auto& [name, field] : zoo::allFields()) {
        TriangleMesh mesh = polygonize(field);
        if (mesh.triangles.empty()) continue;
        const TriangleMesh before = mesh;
        const ZeroSet surface(field);
        relax(mesh, surface, 5);
        EXPECT_EQ(mesh.triangles, before.triangles) << name;
        EXPECT_GE(smallestAngle(mesh), smallestAngle(before)) << name;
        EXPECT_GT(topologyOf(mesh).volume, 0) << name;
        for (std::size_t v = 0; v < mesh.points.size(); ++v) {
            if (mesh.points[v] == before.points[v]) continue;
            const auto foot = surface.foot(toVec(mesh.points[v]));
            ASSERT_TRUE(foot) << name;
            EXPECT_LT((foot->at - toVec(mesh.points[v])).length(), kOnSurface * surface.voxel()) << name;
        }
    }
}

TEST(Relax, MakesASphereOfGoodTriangles) {
    const BSplineField field = fieldFromDistance(14, sphere(9), oblique());
    TriangleMesh mesh = polygonize(field);
    EXPECT_LT(smallestAngle(mesh), 2);
    relax(mesh, ZeroSet(field), 20);
    EXPECT_GT(smallestAngle(mesh), 15);
}

TEST(Relax, DoesNotDependOnThreads) {
    const BSplineField field = fieldFromDistance(16, torus(8, 3));
    std::vector<TriangleMesh> results;
    for (const int threads : {1, 2, 4}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        results.push_back(polygonize(field));
        relax(results.back(), ZeroSet(field), 4);
    }
    for (const TriangleMesh& mesh : results) {
        EXPECT_EQ(mesh.points, results[0].points);
        EXPECT_EQ(mesh.normals, results[0].normals);
    }
}

}  // namespace
}  // namespace isowave
