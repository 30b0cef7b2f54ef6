// The promises of volume/walls/wall_fit.h.
#include "volume/walls/wall_fit.h"
#include "tests/zoo/box.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "volume/distance_mesh.h"
#include "volume/fit.h"

namespace isowave {
namespace {

using openvdb::Vec3d;
using openvdb::math::Mat3d;

Mat3d tilted(double degrees) {
    return openvdb::math::rotation<Mat3d>(Vec3d(0.958, -0.287, 0).unit(), degrees * std::numbers::pi / 180);
}

TriangleMesh boxOf(const Vec3d& half, const Mat3d& turn, const Vec3d& middle) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) {
        const Vec3d corner(i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1],
                           i & 4 ? half[2] : -half[2]);
        const Vec3d p = turn * corner + middle;
        mesh.points.push_back({p[0], p[1], p[2]});
    }
    mesh.triangles.assign(zoo::kBoxTriangles.begin(), zoo::kBoxTriangles.end());
    return mesh;
}

// A tube about an axis tilted by 25 degrees, 20 long.
constexpr double kTubeRadius = 8;
const Vec3d kTubeMiddle(20.13, 20.31, 19.78);
TriangleMesh tubeOf(double wall) {
    constexpr std::uint32_t kAround = 96;
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j < kAround; ++j)
        for (const auto& [r, z] : {std::pair{kTubeRadius - wall, -10.0}, std::pair{kTubeRadius, -10.0},
                                   std::pair{kTubeRadius, 10.0}, std::pair{kTubeRadius - wall, 10.0}}) {
            const double a = 2 * std::numbers::pi * j / kAround;
            const Vec3d p = tilted(25) * Vec3d(r * std::cos(a), r * std::sin(a), z) + kTubeMiddle;
            mesh.points.push_back({p[0], p[1], p[2]});
        }
    for (std::uint32_t j = 0; j < kAround; ++j)
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t a = 4 * j + i, b = 4 * j + (i + 1) % 4, next = (j + 1) % kAround,
                                c = 4 * next + i, d = 4 * next + (i + 1) % 4;
            mesh.triangles.push_back({a, c, d});
            mesh.triangles.push_back({a, d, b});
        }
    return mesh;
}

struct Fitted {
    BSplineField field;
    FitReport fit;
    WallFitReport walls;
};

Fitted fitted(const TriangleMesh& mesh, bool walls = true, bool evenOdd = false) {
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    const auto distance = distanceFromMesh(mesh, *transform, 4, evenOdd);
    std::vector<Vec3d> points;
    for (const Point& p : mesh.points) points.push_back(transform->worldToIndex(Vec3d(p.data())));
    Fitted result;
    DistanceFitOptions options;
    if (walls)
        options.adjust = [&](BSplineField& field, const openvdb::Coord& shift) {
            result.walls = fitWalls(field, distance->tree(), shift, points, mesh.triangles);
        };
    result.field = fitDistance(*distance, options, &result.fit);
    return result;
}

double valueAt(const BSplineField& field, const Vec3d& world) {
    return evaluate(field, field.transform().worldToIndex(world));
}

// How much thicker a plate is than t, of t, far from its rim.
double thicknessError(const BSplineField& field, const Mat3d& turn, const Vec3d& middle, double t) {
    constexpr double kStep = 0.01;
    double inside = 0, places = 0;
    for (double x = -4; x <= 4; x += 0.93)
        for (double y = -4; y <= 4; y += 0.93, ++places)
            for (double z = -t / 2 - 1; z < t / 2 + 1; z += kStep)
                inside += valueAt(field, turn * Vec3d(x, y, z) + middle) < 0;
    return inside * kStep / places / t - 1;
}

std::vector<float> valuesOf(const BSplineField& field) {
    std::vector<float> values;
    for (auto voxel = field.controlPoints->cbeginValueOn(); voxel; ++voxel) values.push_back(*voxel);
    return values;
}

// Lattice points of I where the sign of F is not the shape's.
int wrongSigns(const BSplineField& field) {
    int wrong = 0;
    for (auto point = field.shape->cbeginValueOn(); point; ++point)
        wrong += (evaluate(field, point.getCoord().asVec3d()) < 0) != *point;
    return wrong;
}

TEST(WallFit, PlatesOfOneToThreeVoxelsKeepTheirThicknessAtAnyPlaceAndTilt) {
    double worst = 0, worstPlain = 0;
    for (const double t : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0})
        for (const double tilt : {0.0, 10.0, 45.0})
            for (const double place : {0.07, 0.57}) {
                const Vec3d middle(20.31, 20.77, 20 + place);
                const TriangleMesh mesh = boxOf({10, 10, t / 2}, tilted(tilt), middle);
                const Fitted fit = fitted(mesh);
                worst = std::max(worst, std::abs(thicknessError(fit.field, tilted(tilt), middle, t)));
                worstPlain = std::max(
                    worstPlain, std::abs(thicknessError(fitted(mesh, false).field, tilted(tilt), middle, t)));
                EXPECT_EQ(fit.fit.disagreeing, 0) << t << ' ' << tilt;
                EXPECT_GT(fit.walls.changed, 0);
                EXPECT_NEAR(fit.walls.thinnest, t, 0.01);
            }
    EXPECT_LT(worst, 0.0125);  // seen 0.01
    EXPECT_GT(worstPlain, 0.05);
}

TEST(WallFit, WhatIsNotThinKeepsItsBits) {
    for (const double tilt : {0.0, 20.0}) {
        const TriangleMesh mesh = boxOf(Vec3d(10), tilted(tilt), {20.13, 20.31, 20.22});
        const Fitted walls = fitted(mesh);
        EXPECT_EQ(valuesOf(walls.field), valuesOf(fitted(mesh, false).field)) << tilt;
        EXPECT_EQ(walls.walls.rows, 0);
        EXPECT_EQ(walls.walls.leastRefine, 1);
        EXPECT_EQ(walls.walls.thinnest, 0);
    }
}

TEST(WallFit, AWallThatTheLatticeMissesIsWhole) {
    for (const double wall : {0.23, 0.35, 0.7}) {
        const TriangleMesh mesh = tubeOf(wall);
        const Fitted walls = fitted(mesh), plain = fitted(mesh, false);
        int torn = 0, tornPlain = 0, count = 0;
        for (double z = -9; z <= 9; z += 0.31)
            for (double a = 0; a < 2 * std::numbers::pi; a += 0.03, ++count) {
                const double r = kTubeRadius - wall / 2;
                const Vec3d middle = tilted(25) * Vec3d(r * std::cos(a), r * std::sin(a), z) + kTubeMiddle;
                torn += valueAt(walls.field, middle) >= 0;
                tornPlain += valueAt(plain.field, middle) >= 0;
            }
        EXPECT_EQ(torn, 0) << wall;
        EXPECT_GT(tornPlain, count / 50) << wall;
        EXPECT_NEAR(walls.walls.thinnest, wall, 0.05);
        EXPECT_EQ(walls.walls.leastRefine, wall < 0.5 ? 4 : 2);
    }
}

TEST(WallFit, TheShapeIsTheSignOfFAtEveryLatticePoint) {
    for (const double wall : {0.1, 0.23, 0.5, 1.0}) {
        const Fitted fit = fitted(tubeOf(wall));
        EXPECT_EQ(wrongSigns(fit.field), 0) << wall;
        EXPECT_EQ(fit.fit.disagreeing, 0) << wall;
        EXPECT_EQ(fit.walls.thickened > 0, wall < 0.25) << wall;
    }
}

TEST(WallFit, GivesTheSameBitsForAnyThreads) {
    const TriangleMesh mesh = tubeOf(0.35);
    std::vector<std::vector<float>> results;
    for (const std::size_t threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        results.push_back(valuesOf(fitted(mesh).field));
    }
    EXPECT_EQ(results[0], results[1]);
}

TEST(WallFit, DoesNotDependOnTheOrientationOfTheMesh) {
    const Vec3d middle(20.31, 20.77, 20.4);
    const TriangleMesh mesh = boxOf({10, 10, 0.6}, tilted(10), middle);
    TriangleMesh turned = mesh, mixed = mesh;
    for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
    for (std::size_t i = 0; i < mixed.triangles.size(); i += 2)
        std::swap(mixed.triangles[i][1], mixed.triangles[i][2]);
    const auto right = valuesOf(fitted(mesh).field);
    EXPECT_EQ(valuesOf(fitted(turned).field), right);
    EXPECT_LT(std::abs(thicknessError(fitted(mixed, true, true).field, tilted(10), middle, 1.2)), 0.01);
}

TEST(WallFit, BearsDegenerateTriangles) {
    const Vec3d middle(20.31, 20.77, 20.4);
    TriangleMesh mesh = boxOf({10, 10, 0.6}, tilted(10), middle);
    mesh.triangles.push_back({0, 0, 1});
    mesh.triangles.push_back({3, 3, 3});
    const Fitted fit = fitted(mesh);
    EXPECT_LT(std::abs(thicknessError(fit.field, tilted(10), middle, 1.2)), 0.01);
    EXPECT_EQ(wrongSigns(fit.field), 0);
}

TEST(WallFit, AGapOfAVoxelStaysOpenAndOneBelowTheSamplesIsClosed) {
    for (const double gap : {0.1, 1.0}) {
        const Vec3d middle(20.31, 20.77, 20.4), across(0, 0, 4 + gap / 2);
        TriangleMesh mesh = boxOf({8, 8, 4}, tilted(15), middle - tilted(15) * across);
        const TriangleMesh other = boxOf({8, 8, 4}, tilted(15), middle + tilted(15) * across);
        mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
        for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
        const Fitted fit = fitted(mesh);
        int open = 0, count = 0;
        for (double x = -6; x <= 6; x += 0.37)
            for (double y = -6; y <= 6; y += 0.37, ++count)
                open += valueAt(fit.field, tilted(15) * Vec3d(x, y, 0) + middle) >= 0;
        EXPECT_EQ(open, gap < 0.5 ? 0 : count) << gap;
        EXPECT_EQ(wrongSigns(fit.field), 0);
    }
}

}  // namespace
}  // namespace isowave
