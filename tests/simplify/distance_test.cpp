#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>

#include "isowave/error.h"
#include "simplify/distance.h"
#include "simplify/shapes.h"

namespace isowave {
namespace {

using namespace shapes;

// The distance to a triangle the slow way, written independently of the code under test: the minimum over the
// plane's foot (barycentric coordinates, if all are positive) and a ternary search along the three sides.
double slowDistance(const Point& q, const Point& a, const Point& b, const Point& c) {
    const auto alongSide = [&](const Point& u, const Point& v) {
        double low = 0, high = 1;
        const auto at = [&](double t) { return length(u + t * (v - u) - q); };
        for (int i = 0; i < 200; ++i) {
            const double t1 = low + (high - low) / 3, t2 = high - (high - low) / 3;
            (at(t1) < at(t2) ? high : low) = at(t1) < at(t2) ? t2 : t1;
        }
        return at(low);
    };
    double best = std::min({alongSide(a, b), alongSide(b, c), alongSide(c, a)});
    const Point u = b - a, v = c - a, w = q - a;
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), det = uu * vv - uv * uv;
    const double s = (vv * dot(w, u) - uv * dot(w, v)) / det, t = (uu * dot(w, v) - uv * dot(w, u)) / det;
    if (s > 0 && t > 0 && s + t < 1) best = std::min(best, length(w - s * u - t * v));
    return best;
}

double slowDistance(const Point& q, const TriangleMesh& mesh) {
    double best = INFINITY;
    for (const Triangle& t : mesh.triangles)
        best = std::min(best, slowDistance(q, mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]));
    return best;
}

// Points spread over every triangle: all barycentric multiples of 1/n.
template <class Visit>
void visitDensely(const TriangleMesh& mesh, int n, const Visit& visit) {
    for (const Triangle& t : mesh.triangles) {
        const Point &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
        for (int i = 0; i <= n; ++i)
            for (int j = 0; i + j <= n; ++j) visit(a + (1.0 * i / n) * (b - a) + (1.0 * j / n) * (c - a));
    }
}

TEST(DistanceTarget, AgreesWithASlowSearchOnTrianglesOfAllProportions) {
    const TriangleMesh target = soup(60, 1);
    const DistanceTarget tree(target);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(-0.5, 1.5);
    for (int i = 0; i < 400; ++i) {
        const Point q = {unit(random), unit(random), unit(random)};
        const double slow = slowDistance(q, target);
        EXPECT_NEAR(tree.distance(q), slow, 1e-7);  // the search is good to half the digits
        EXPECT_NEAR(std::sqrt(tree.squaredBeyond(q, 0.5 * slow * slow)), slow, 1e-7);
        EXPECT_LE(tree.squaredBeyond(q, 2 * slow * slow), 2 * slow * slow);
    }
}

TEST(DistanceTarget, TakesATriangleWithoutAreaForTheSegmentThatItIs) {
    TriangleMesh flat;
    flat.points = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}};
    flat.triangles = {{0, 1, 2}, {2, 2, 2}};
    const DistanceTarget tree(flat);
    EXPECT_DOUBLE_EQ(tree.distance({0.5, 3, 0}), 3);
    EXPECT_DOUBLE_EQ(tree.distance({-3, 4, 0}), 5);
    const OneSidedDistance fromFlat = DistanceTarget(sphere(1, 2, {0, 5, 0})).distanceFrom(flat, 0.1);
    EXPECT_NEAR(fromFlat.max, std::sqrt(29.0) - 1, 0.1);
    EXPECT_TRUE(std::isfinite(fromFlat.mean) && std::isfinite(fromFlat.maxBound));
}

TEST(Distance, ConcentricSpheresAreTheirRadiiApartWithinTheSagOfTheirTriangles) {
    // A triangle of side h sags by about h^2/8: the error falls four times a level.
    double before = 0;
    for (int level = 2; level <= 5; ++level) {
        const OneSidedDistance d = DistanceTarget(sphere(1.5, level)).distanceFrom(sphere(1, level));
        const double error = std::max(std::abs(d.mean - 0.5), std::abs(d.rms - 0.5));
        if (level > 2) {
            EXPECT_GT(before / error, 3.5) << level;  // seen 3.99 to 4.01
        }
        before = error;
    }
    EXPECT_LT(before, 5e-4);  // seen 1.2e-4
}

TEST(Distance, AMeshLiesOnItself) {
    const TriangleMesh mesh = sphere(3, 4, {100, -50, 7});
    const MeshComparison c = compareMeshes(mesh, mesh);
    EXPECT_LT(c.max, 1e-13);
    EXPECT_LE(c.rms, c.max);
    EXPECT_LT(c.maxBound, 1e-12);  // every piece lies on one triangle of the target
    EXPECT_EQ(c.volumeDifference, 0);
}

TEST(Distance, ASpeckThatOnlyOneMeshHasIsSeenFromThatSideOnly) {
    const TriangleMesh b = sphere(1, 4), a = together(b, sphere(0.1, 1, {6, 0, 0}));
    const MeshComparison c = compareMeshes(a, b);
    EXPECT_NEAR(c.aToB.max, 5.1, 0.02);
    EXPECT_LT(c.bToA.max, 1e-14);
    EXPECT_EQ(c.max, c.aToB.max);
    EXPECT_LT(c.volumeDifference, 0);
}

TEST(Distance, QuadratureIsExactForADistanceThatVariesLinearly) {
    TriangleMesh plane, tilted;
    plane.points = {{-90, -90, 0}, {90, -90, 0}, {0, 90, 0}};
    plane.triangles = {{0, 1, 2}};
    tilted.points = {{0, 0, 1}, {2, 0, 3}, {0, 1, 8}};
    tilted.triangles = {{0, 1, 2}};
    for (const double spacing : {0.0, 0.1}) {
        const OneSidedDistance d = DistanceTarget(plane).distanceFrom(tilted, spacing);
        // mean of a linear function: (u+v+w)/3; of its square: (u^2+v^2+w^2+uv+vw+wu)/6
        EXPECT_NEAR(d.mean, 4.0, 1e-12) << spacing;
        EXPECT_NEAR(d.rms, std::sqrt((1 + 9 + 64 + 3 + 24 + 8) / 6.0), 1e-12) << spacing;
        EXPECT_EQ(d.max, 8.0);
    }
}

TEST(Distance, MaxBoundHoldsEverywhereBetweenSamples) {
    const TriangleMesh from = soup(80, 3), to = soup(80, 4);
    const DistanceTarget target(to);
    for (const double spacing : {0.0, 0.05, 0.01}) {
        const OneSidedDistance d = target.distanceFrom(from, spacing);
        double dense = 0;
        visitDensely(from, 30, [&](const Point& p) { dense = std::max(dense, target.distance(p)); });
        EXPECT_LE(d.max, d.maxBound);
        EXPECT_LE(dense, d.maxBound);
        if (spacing > 0) {
            EXPECT_LE(d.maxBound, d.max + spacing);
        }
    }
}

TEST(Distance, WithoutABoundTakesTheSameSamples) {
    const DistanceTarget target(soup(80, 4));
    const TriangleMesh from = soup(80, 3);
    for (const double spacing : {0.0, 0.05}) {
        const OneSidedDistance bounded = target.distanceFrom(from, spacing),
                               sampled = target.sampledDistanceFrom(from, spacing);
        EXPECT_EQ(sampled.mean, bounded.mean);
        EXPECT_EQ(sampled.rms, bounded.rms);
        EXPECT_EQ(sampled.area, bounded.area);
        EXPECT_LE(sampled.samples, bounded.samples);
        EXPECT_LE(sampled.max, bounded.max);  // halved pieces show a little more
        EXPECT_GT(sampled.max, 0.9 * bounded.max);
        EXPECT_TRUE(std::isinf(sampled.maxBound));
    }
}

TEST(Distance, CornersAndCentroidsAloneDoNotBound) {
    // So the test above can fail: a needle that pokes through a triangle between its corners and its
    // centroid.
    TriangleMesh triangle, corners;
    triangle.points = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}};
    triangle.triangles = {{0, 1, 2}};
    for (const Point& p : {Point{0, 0, 0}, Point{9, 0, 0}, Point{0, 9, 0}, Point{3, 3, 0}})
        corners = together(corners, sphere(0.1, 0, p));
    const DistanceTarget target(corners);
    const OneSidedDistance d = target.distanceFrom(triangle);
    double dense = 0;
    visitDensely(triangle, 50, [&](const Point& p) { dense = std::max(dense, target.distance(p)); });
    const auto atSample = [&](const Point& p) { return target.distance(p); };
    EXPECT_GT(dense, 10 * std::max({atSample({0, 0, 0}), atSample({9, 0, 0}), atSample({3, 3, 0})}));
    EXPECT_LE(dense, d.maxBound);
    EXPECT_LT(d.maxBound, 1.0101 * d.max);
}

TEST(Distance, HalvingTheSpacingTriplesTheCostOfASliver) {
    TriangleMesh sliver;
    sliver.points = {{0, 0, 0}, {100, 0, 0}, {50, 1e-3, 0}};
    sliver.triangles = {{0, 1, 2}};
    const DistanceTarget target(sphere(1, 2));
    double before = 0;
    for (const double spacing : {0.4, 0.2, 0.1}) {
        const auto samples = static_cast<double>(target.distanceFrom(sliver, spacing).samples);
        if (before > 0) {
            EXPECT_LT(samples / before, 3.2) << spacing;  // seen 3.00; a regular grid has 4
        }
        before = samples;
    }
}

TEST(Distance, PointsOfNoTriangleDoNotCount) {
    TriangleMesh mesh = sphere(1, 2);
    const OneSidedDistance without = DistanceTarget(sphere(2, 2)).distanceFrom(mesh);
    mesh.points.push_back({1000, 0, 0});
    const OneSidedDistance with = DistanceTarget(sphere(2, 2)).distanceFrom(mesh);
    EXPECT_EQ(with.max, without.max);
    EXPECT_EQ(with.samples, without.samples);
}

TEST(Distance, IsTheSameToTheBitForAnyNumberOfThreads) {
    const TriangleMesh a = sphere(1, 5), b = sphere(1.1, 4, {0.05, 0.02, -0.01});
    std::vector<MeshComparison> results;
    for (const int threads : {1, 2, 4}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        results.push_back(compareMeshes(a, b, 0.02));
    }
    for (const MeshComparison& r : results) {
        EXPECT_EQ(r.mean, results[0].mean);
        EXPECT_EQ(r.rms, results[0].rms);
        EXPECT_EQ(r.max, results[0].max);
        EXPECT_EQ(r.maxBound, results[0].maxBound);
        EXPECT_EQ(r.aToB.samples, results[0].aToB.samples);
    }
}

TEST(Comparison, WeighsBothSurfacesByTheirArea) {
    const MeshComparison c = compareMeshes(sphere(1, 4), sphere(2, 4));
    const double areaA = c.aToB.area, areaB = c.bToA.area;
    EXPECT_NEAR(areaB / areaA, 4, 1e-12);
    EXPECT_NEAR(c.mean, (areaA * c.aToB.mean + areaB * c.bToA.mean) / (areaA + areaB), 1e-14);
    EXPECT_NEAR(c.volumeB / c.volumeA, 8, 1e-12);
    EXPECT_NEAR(c.volumeDifference, c.volumeB - c.volumeA, 0);
}

TEST(Comparison, VolumeDoesNotSufferFromAFarOrigin) {
    const double near = compareMeshes(tetrahedron(1), tetrahedron(1)).volumeA;
    const double far = compareMeshes(tetrahedron(1, {1e6, 1e6, 1e6}), tetrahedron(1)).volumeA;
    EXPECT_DOUBLE_EQ(near, 1.0 / 6);
    EXPECT_NEAR(far, 1.0 / 6, 1e-9);
}

TEST(Comparison, RefusesAMeshWithoutTriangles) {
    EXPECT_THROW(compareMeshes(TriangleMesh{}, tetrahedron(1)), InputError);
    EXPECT_THROW(compareMeshes(tetrahedron(1), TriangleMesh{}), InputError);
}

TEST(Comparison, StopsWhenAsked) {
    std::atomic<int> asked = 0;
    Progress progress;
    progress.stopRequested = [&] { return ++asked > 3; };
    EXPECT_THROW(compareMeshes(sphere(1, 5), sphere(2, 5), 0, progress), Cancelled);
}

// One triangle cut into 10^5 samples is one step of the progress, but many of the wish to stop.
TEST(Comparison, StopsWithinATriangle) {
    const TriangleMesh a{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
    const TriangleMesh b{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}}, {}};
    std::atomic<int> asked = 0;
    Progress progress;
    progress.stopRequested = [&] { return ++asked > 1000; };
    EXPECT_THROW(compareMeshes(a, b, 1.0 / 256, progress), Cancelled);
    EXPECT_LT(asked, 1100);
}

}  // namespace
}  // namespace isowave
