// Measures of solids whose measures are known, and meshes that are no solids.
#include <gtest/gtest.h>

#include "polygonize/topology.h"
#include "simplify/distance.h"
#include "simplify/shapes.h"

namespace isowave {
namespace {

using namespace shapes;

TEST(KnownSolids, VolumeAndAreaOfASphereComeFourTimesCloserForHalvedTriangles) {
    const double volume = 4.0 / 3 * M_PI * 27, area = 4 * M_PI * 9;
    double volumeBefore = 0, areaBefore = 0;
    for (int level = 2; level <= 6; ++level) {
        const MeshTopology t = topologyOf(sphere(3, level));
        const double volumeError = volume - t.volume, areaError = area - t.area;
        EXPECT_GT(volumeError, 0) << level;  // corners on the sphere: the mesh is inside
        EXPECT_GT(areaError, 0) << level;
        if (level > 2) {
            EXPECT_NEAR(volumeBefore / volumeError, 4, 0.1) << level;  // seen 3.95 to 4.00
            EXPECT_NEAR(areaBefore / areaError, 4, 0.1) << level;
        }
        volumeBefore = volumeError;
        areaBefore = areaError;
    }
    EXPECT_LT(volumeBefore, 1e-3 * volume);  // seen 4e-4
    EXPECT_LT(areaBefore, 1e-3 * area);
}

TEST(KnownSolids, TwoSpheresAreTwoComponentsAndASphereInAnotherIsACavity) {
    const MeshTopology two = topologyOf(together(sphere(2, 3), sphere(1, 3, {5, 0, 0})));
    EXPECT_EQ(two.components, 2);
    EXPECT_EQ(two.genus, 0);
    EXPECT_NEAR(two.each[0].volume / two.each[1].volume, 8, 1e-9);

    TriangleMesh inner = sphere(1, 3);
    for (Triangle& t : inner.triangles) std::swap(t[1], t[2]);
    const MeshTopology shell = topologyOf(together(sphere(2, 3), inner));
    EXPECT_TRUE(shell.closed() && shell.manifold() && shell.oriented());
    EXPECT_LT(shell.each[1].volume, 0);
    EXPECT_NEAR(shell.volume / two.each[1].volume, 7, 1e-9);
}

TEST(KnownSolids, AMissingAFlippedTriangleAndASharedVertexAreSeen) {
    const TriangleMesh whole = sphere(1, 3);
    ASSERT_TRUE(topologyOf(whole).closed() && topologyOf(whole).manifold() && topologyOf(whole).oriented());

    TriangleMesh missing = whole;
    missing.triangles.pop_back();
    EXPECT_FALSE(topologyOf(missing).closed());
    EXPECT_EQ(topologyOf(missing).boundaryEdges, 3);

    TriangleMesh flipped = whole;
    std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
    EXPECT_FALSE(topologyOf(flipped).oriented());
    EXPECT_EQ(topologyOf(flipped).misorientedEdges, 3);

    TriangleMesh touching = together(whole, sphere(1, 3, {4, 0, 0}));
    for (Triangle& t : touching.triangles)
        for (std::uint32_t& v : t)
            if (v == whole.points.size()) v = 0;
    EXPECT_FALSE(topologyOf(touching).manifold());
    EXPECT_EQ(topologyOf(touching).nonManifoldVertices, 1);
}

// The maximum between a mesh and a coarser one, from a hundred times as many points as compareMeshes() takes.
double denseMaximum(const TriangleMesh& from, const DistanceTarget& to) {
    double dense = 0;
    constexpr int n = 24;
    for (const Triangle& t : from.triangles) {
        const Point &a = from.points[t[0]], &b = from.points[t[1]], &c = from.points[t[2]];
        for (int i = 0; i <= n; ++i)
            for (int j = 0; i + j <= n; ++j)
                dense = std::max(dense, to.distance(a + (1.0 * i / n) * (b - a) + (1.0 * j / n) * (c - a)));
    }
    return dense;
}

TEST(KnownSolids, TheBoundOnTheMaximumIsTrueAndWithinOnePercent) {
    const TriangleMesh fine = sphere(3, 4), coarse = sphere(3, 2, {0.1, 0.02, -0.05});
    const DistanceTarget toFine(fine), toCoarse(coarse);
    for (const double spacing : {0.0, 0.3}) {
        const MeshComparison c = compareMeshes(fine, coarse, spacing);
        EXPECT_LE(denseMaximum(fine, toCoarse), c.aToB.maxBound);
        EXPECT_LE(denseMaximum(coarse, toFine), c.bToA.maxBound);
        EXPECT_LE(c.aToB.maxBound, 1.0101 * c.aToB.max);
        EXPECT_LE(c.bToA.maxBound, 1.0101 * c.bToA.max);
    }
}

TEST(KnownSolids, AConcentricSphereIsMeasuredExactlyBySamplesOfAFlatFace) {
    // A large flat triangle over a ball: nearest at the middle, farthest at the corners.
    TriangleMesh plate;
    plate.points = {{-40, -40, 5}, {40, -40, 5}, {0, 50, 5}};
    plate.triangles = {{0, 1, 2}};
    const OneSidedDistance toPlate = DistanceTarget(plate).distanceFrom(sphere(1, 4));
    EXPECT_NEAR(toPlate.max, 6, 0.01);
    EXPECT_LE(toPlate.maxBound, 6.01);
    const OneSidedDistance toBall = DistanceTarget(sphere(1, 4)).distanceFrom(plate);
    EXPECT_NEAR(toBall.max, std::hypot(40, 40, 5) - 1, 0.01);
    EXPECT_LE(toBall.maxBound, 1.0101 * toBall.max);
}

}  // namespace
}  // namespace isowave
