#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <atomic>

#include "isowave/error.h"
#include "volume/distance.h"
#include "volume/mesh_checks.h"
#include "volume/sign_tiles.h"

namespace isowave {
namespace {

using checks::box, checks::nestedShells, checks::reversed;
using openvdb::Coord;
using openvdb::Vec3d;
using openvdb::math::Transform;
using shapes::sphere, shapes::together;

const Transform::Ptr kUnit = Transform::createLinearTransform(1.0);

struct Worst {
    double value = 0;     // largest |value - expected|
    long wrongSign = 0;   // points with another sign than expected
    long wrongState = 0;  // active though far, or inactive though near
};

// Every lattice point of a box against brute force on a mesh given in index space.
Worst compareWithBruteForce(const openvdb::FloatGrid& grid, const TriangleMesh& mesh, double halfWidth,
                            const openvdb::CoordBBox& where) {
    Worst worst;
    const auto values = grid.getConstAccessor();
    for (auto point = where.begin(); point; ++point) {
        const Vec3d p = (*point).asVec3d();
        const double distance = checks::distanceTo(mesh, p);
        const bool inside = std::round(checks::windingNumber(mesh, p)) != 0;
        const float value = values.getValue(*point);
        worst.value = std::max(worst.value, std::abs(std::abs(value) - std::min(distance, halfWidth)));
        worst.wrongSign += std::signbit(value) != inside;
        worst.wrongState += values.isValueOn(*point) != (distance < halfWidth);
    }
    return worst;
}

TEST(DistanceFromMesh, IsExactAtEveryLatticePointAroundNestedShells) {
    const TriangleMesh mesh = nestedShells(1, {19.37, 20.11, 18.83});
    for (const double halfWidth : {1.0, 2.5, 4.0}) {
        const auto grid = distanceFromMesh(mesh, *kUnit, halfWidth);
        const Worst worst = compareWithBruteForce(*grid, mesh, halfWidth, {Coord(0), Coord(39)});
        EXPECT_LT(worst.value, 1e-6) << halfWidth;  // seen 1.2e-7
        EXPECT_EQ(worst.wrongSign, 0) << halfWidth;
        EXPECT_EQ(worst.wrongState, 0) << halfWidth;
        EXPECT_EQ(grid->background(), float(halfWidth));
        EXPECT_EQ(grid->tree().getValue(Coord(1000)), float(halfWidth));
    }
}

// Thousands of triangles in a few voxels are measured another way.
TEST(DistanceFromMesh, IsExactForTrianglesMuchSmallerThanAVoxel) {
    const TriangleMesh mesh = sphere(5.3, 5, {15.37, 16.11, 14.83});
    ASSERT_GT(mesh.triangles.size(), 8000u);
    const auto grid = distanceFromMesh(mesh, *kUnit, 4.0);
    for (int n = 0; n < 400; ++n) {
        const Coord at(5 + n * 7 % 21, 6 + n * 5 % 20, 5 + n * 3 % 19);
        const double expected = std::min(checks::distanceTo(mesh, at.asVec3d()), 4.0);
        ASSERT_NEAR(std::abs(grid->tree().getValue(at)), expected, 1e-6) << at;
    }
}

// Why the distances are ours.
TEST(DistanceFromMesh, ReplacesMeshToVolumeWhichErrsInItsOuterBandAndFillsVoids) {
    const TriangleMesh mesh = nestedShells(3, {19.37, 20.11, 18.83});
    std::vector<openvdb::Vec3s> points;
    for (const Point& p : mesh.points) points.emplace_back(Vec3d(p.data()));
    std::vector<openvdb::Vec3I> triangles;
    for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    const auto theirs = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*kUnit, points, triangles, 4.0f);
    const auto ours = distanceFromMesh(mesh, *kUnit, 4.0);
    double worst = 0;
    for (auto value = ours->cbeginValueOn(); value; ++value) {
        const double error = std::abs(*value) - std::abs(theirs->tree().getValue(value.getCoord()));
        worst = std::max(worst, std::abs(error));
    }
    EXPECT_GT(worst, 0.05);
    const Coord inVoid(27, 20, 19);  // 8 from the centre, between 5.2 and 10.7
    EXPECT_GT(ours->tree().getValue(inVoid), 0);
    EXPECT_LT(theirs->tree().getValue(inVoid), 0);
}

TEST(DistanceFromMesh, HoldsABigSolidInTiles) {
    const auto grid = distanceFromMesh(box({0.4, 0.4, 0.4}, {300.4, 300.4, 300.4}), *kUnit, 4.0);
    const auto values = grid->getConstAccessor();
    EXPECT_EQ(values.getValue(Coord(150)), -4.0f);
    EXPECT_FALSE(values.isValueOn(Coord(150)));
    EXPECT_EQ(grid->tree().probeConstLeaf(Coord(150)), nullptr);
    EXPECT_EQ(values.getValue(Coord(310)), 4.0f);
    EXPECT_NEAR(values.getValue(Coord(150, 150, 0)), 0.4, 1e-6);
    EXPECT_NEAR(values.getValue(Coord(150, 150, 1)), -0.6, 1e-6);
    EXPECT_LT(double(grid->memUsage()), 60e6);  // seen 42e6; dense, 108e6
}

TEST(DistanceFromMesh, KeepsVoidsAndSolidsInTilesApart) {
    // Walls 24 apart: between them, every lattice point far from a wall lies in a tile.
    TriangleMesh mesh;
    for (int shell = 0; shell < 4; ++shell) {
        const double low = 0.4 + 24 * shell, high = 192.4 - 24 * shell;
        const TriangleMesh wall = box({low, low, low}, {high, high, high});
        mesh = together(mesh, shell % 2 == 0 ? wall : reversed(wall));
    }
    const auto grid = distanceFromMesh(mesh, *kUnit, 3.0);
    for (int x = -20; x < 212; x += 3) {
        const Coord p(x, 97, 95);
        const int depth = std::min({std::max(0, (x + 23) / 24), std::max(0, (216 - x) / 24), 4});
        const float value = grid->tree().getValue(p);
        EXPECT_EQ(std::signbit(value), depth % 2 == 1) << x << " depth " << depth << " value " << value;
    }
}

TEST(DistanceFromMesh, IsNeverZeroOnTheSurface) {
    const auto grid = distanceFromMesh(box({2, 2, 2}, {9, 9, 9}), *kUnit, 3.0);
    EXPECT_EQ(grid->tree().getValue(Coord(2, 5, 5)), -0x1p-20f);
    EXPECT_EQ(grid->tree().getValue(Coord(9, 5, 5)), 0x1p-20f);
}

TEST(DistanceFromMesh, CountsCrossingsWhereOrientationCannotBeTrusted) {
    const TriangleMesh mesh =
        together(sphere(15.3, 2), sphere(8.7, 2));  // the void's wall faces the wrong way
    EXPECT_LT(distanceFromMesh(mesh, *kUnit, 3.0, false)->tree().getValue(Coord(0)), 0);
    EXPECT_GT(distanceFromMesh(mesh, *kUnit, 3.0, true)->tree().getValue(Coord(0)), 0);
}

TEST(DistanceFromMesh, LeavesNoDentWherePartsOverlapOrTouch) {
    const TriangleMesh whole = box({0.4, 0.4, 0.4}, {20.4, 40.4, 20.4});
    const auto reference = distanceFromMesh(whole, *kUnit, 4.0);
    const TriangleMesh lower = box({0.4, 0.4, 0.4}, {20.4, 23.4, 20.4});
    for (const double start : {23.4, 17.4}) {  // the upper part touches the lower one, or overlaps it
        const TriangleMesh parts = together(lower, box({0.4, start, 0.4}, {20.4, 40.4, 20.4}));
        for (const bool evenOdd : {false, true}) {
            if (evenOdd && start < 23) continue;  // the overlap would be a void
            const auto grid = distanceFromMesh(parts, *kUnit, 4.0, evenOdd);
            EXPECT_EQ(grid->tree().getValue(Coord(10, 23, 10)), -4.0f) << "0.4 from the buried face";
            for (auto point = openvdb::CoordBBox(Coord(-4), Coord(25, 45, 25)).begin(); point; ++point) {
                const float expected = reference->tree().getValue(*point),
                            found = grid->tree().getValue(*point);
                if (expected > 0) {
                    ASSERT_NEAR(found, expected, 1e-6) << *point;
                } else {
                    ASSERT_GE(found, expected) << *point;  // never farther than the truth
                    ASSERT_LE(found, std::min(expected + 2.3f, -0x1p-20f)) << *point;
                }
            }
        }
    }
}

TEST(DistanceFromMesh, CarriesAnyUniformTransform) {
    // Turned, mirrored, scaled, moved: the same solid in index space.
    const TriangleMesh index = nestedShells(1, {19.37, 20.11, 18.83});
    auto transform = Transform::createLinearTransform(0.25);
    transform->preRotate(0.7, openvdb::math::Z_AXIS);
    transform->postScale(Vec3d(-1, 1, 1));
    transform->postTranslate(Vec3d(100, -50, 3));
    TriangleMesh world = index;
    for (Point& p : world.points) {
        const Vec3d moved = transform->indexToWorld(Vec3d(p.data()));
        p = {moved.x(), moved.y(), moved.z()};
    }
    const auto grid = distanceFromMesh(world, *transform, 4.0);
    EXPECT_EQ(grid->transform(), *transform);
    const Worst worst = compareWithBruteForce(*grid, index, 4.0, {Coord(0), Coord(39)});
    EXPECT_LT(worst.value, 1e-6);
    EXPECT_EQ(worst.wrongSign, 0);
}

TEST(DistanceFromMesh, FallsFourfoldTowardsTheSphereWithEveryFinerMesh) {
    // Chords of a sphere of radius r fall short by e^2 / 8r: a quarter for every halved edge e.
    double before = 0;
    for (int level = 2; level <= 5; ++level) {
        const auto grid = distanceFromMesh(sphere(20.5, level), *kUnit, 2.0);
        double worst = 0;
        for (auto value = grid->cbeginValueOn(); value; ++value) {
            const double expected = value.getCoord().asVec3d().length() - 20.5;
            worst = std::max(worst, std::abs(*value - expected));
        }
        if (level > 2) {
            EXPECT_NEAR(before / worst, 4.0, 0.6) << level;
        }
        before = worst;
    }
    EXPECT_LT(before, 0.02);
}

TEST(DistanceFromMesh, DependsOnNoThread) {
    const TriangleMesh mesh = nestedShells(3, {0.1, 0.2, 0.3});
    const auto with = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return distanceFromMesh(mesh, *kUnit, 4.0);
    };
    const auto one = with(1);
    for (const std::size_t threads : {2, 4}) {
        const auto other = with(threads);
        EXPECT_TRUE(one->tree().hasSameTopology(other->tree()));
        for (auto value = one->cbeginValueAll(); value; ++value) {
            ASSERT_EQ(*value, other->tree().getValue(value.getCoord()));
        }
    }
}

TEST(DistanceFromMesh, RefusesAMeshThatIsNotClosed) {
    TriangleMesh mesh = sphere(10.3, 2);
    mesh.triangles.pop_back();
    EXPECT_THROW(distanceFromMesh(mesh, *kUnit, 4.0), InputError);
}

TEST(DistanceFromMesh, ReportsAndStopsWhereverItIsAsked) {
    const TriangleMesh mesh = sphere(20.3, 3);
    std::atomic<int> asked = 0, reported = 0;
    Progress progress;
    progress.stopRequested = [&] { return ++asked, false; };
    progress.report = [&](std::string_view, double done) { reported += done >= 0 && done <= 1; };
    distanceFromMesh(mesh, *kUnit, 4.0, false, progress);
    EXPECT_GT(reported, 5);
    const int questions = asked;
    ASSERT_GT(questions, 10);
    for (const int after : {1, 3, questions / 2, questions - 3}) {
        asked = 0;
        progress.stopRequested = [&] { return ++asked > after; };
        EXPECT_THROW(distanceFromMesh(mesh, *kUnit, 4.0, false, progress), Cancelled) << after;
    }
}

TEST(DistanceFromMesh, OfNothingIsOutside) {
    const auto grid = distanceFromMesh({}, *kUnit, 4.0);
    EXPECT_TRUE(grid->empty());
    EXPECT_EQ(grid->tree().getValue(Coord(0)), 4.0f);
}

TEST(TransformForMesh, SpansTheCountAndKeepsFacesOffTheLattice) {
    const TriangleMesh mesh = box({-7, 100, 3}, {5, 124, 9});  // 12 x 24 x 6
    const double voxel = voxelForCount(mesh, 96);
    EXPECT_DOUBLE_EQ(voxel, 0.25);
    const auto transform = transformForMesh(mesh, voxel);
    const Vec3d low = transform->worldToIndex(Vec3d(-7, 100, 3)),
                high = transform->worldToIndex(Vec3d(5, 124, 9));
    const double fraction = (3 - std::sqrt(5.0)) / 2;
    EXPECT_NEAR((low - Vec3d(fraction)).length(), 0, 1e-12);
    EXPECT_NEAR((high - Vec3d(48, 96, 24) - Vec3d(fraction)).length(), 0, 1e-12);
    const auto grid = distanceFromMesh(mesh, *transform, 3.0);
    float least = 3;
    for (auto value = grid->cbeginValueOn(); value; ++value) least = std::min(least, std::abs(*value));
    EXPECT_NEAR(least, fraction, 1e-6);
}

TEST(EstimateBandVoxels, ForetellsTheActiveCount) {
    const TriangleMesh round = sphere(3.0, 4), thin = box({0, 0, 0}, {40, 30, 0.5});
    for (const double voxel : {0.2, 0.1, 0.05}) {
        const auto grid = distanceFromMesh(round, *transformForMesh(round, voxel), 4.0);
        EXPECT_NEAR(estimateBandVoxels(round, voxel, 4.0) / double(grid->activeVoxelCount()), 1.0, 0.1)
            << voxel;
    }
    // Thin: the two sides' bands overlap, the estimate counts both.
    const auto grid = distanceFromMesh(thin, *transformForMesh(thin, 0.25), 4.0);
    const double ratio = estimateBandVoxels(thin, 0.25, 4.0) / double(grid->activeVoxelCount());
    EXPECT_GT(ratio, 1.0);
    EXPECT_LT(ratio, 2.0);
    // A count that nobody can hold is still a number.
    EXPECT_GT(estimateBandVoxels(round, voxelForCount(round, 100000), 4.0), 1e11);
}

TEST(SignTiles, PutsInsideTilesIntoTheRoot) {
    // Too large to mesh in a test: 3 x 3 x 3 root slots of 4096, the one in the middle inside and without a
    // child.
    const openvdb::CoordBBox box(Coord(0), Coord(3 * 4096 - 1));
    const openvdb::CoordBBox solid(Coord(4090), Coord(8198));
    openvdb::FloatTree tree(4.0f);
    tree.touchLeaf(Coord(4088));  // a corner of the solid, in slot (0, 0, 0)
    signTiles(tree, box, 4.0f, [&](const Coord& p) { return solid.isInside(p); });
    EXPECT_EQ(tree.getValue(Coord(5000)), -4.0f);
    EXPECT_FALSE(tree.isValueOn(Coord(5000)));
    EXPECT_EQ(tree.getValue(Coord(10000)), -4.0f);  // slot (2, 2, 2): its first point is inside
    EXPECT_EQ(tree.getValue(Coord(1000)), 4.0f);
    EXPECT_EQ(tree.getValue(Coord(4095, 4095, 100)), 4.0f);
    EXPECT_EQ(tree.getValue(Coord(20000)), 4.0f);
}

}  // namespace
}  // namespace isowave
