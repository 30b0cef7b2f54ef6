// How thick walls are, before anything is fitted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lod/dry_run/wall_thickness.h"

namespace isowave::lod {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::vector<double> kShares{0.01, 0.05, 0.5};

// Rings of vertices between two poles; inside out where `turned`.
void addSphere(TriangleMesh& mesh, double radius, bool turned) {
    constexpr int kAround = 96, kRings = 48;
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    const double turn = 2 * std::acos(-1.0);
    for (int j = 0; j <= kRings; ++j)
        for (int i = 0; i < kAround; ++i) {
            const double u = turn * i / kAround, v = turn / 2 * j / kRings;
            mesh.points.push_back({radius * std::sin(v) * std::cos(u), radius * std::sin(v) * std::sin(u),
                                   radius * std::cos(v)});
        }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (turned) std::swap(b, c);
        mesh.triangles.push_back({first + a, first + b, first + c});
    };
    for (std::uint32_t j = 0; j < kRings; ++j)
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const std::uint32_t next = (i + 1) % kAround, a = j * kAround + i, b = (j + 1) * kAround + i,
                                c = (j + 1) * kAround + next, d = j * kAround + next;
            if (j + 1 < kRings) add(a, b, c);
            if (j > 0) add(a, c, d);
        }
}

TEST(WallThickness, OfASphericalShellIsTheDifferenceOfItsRadii) {
    TriangleMesh shell;
    addSphere(shell, 10, false);
    addSphere(shell, 9, true);
    for (const double thickness : thinnestWalls(shell, kShares)) EXPECT_NEAR(thickness, 1, 0.02);
}

TEST(WallThickness, OfABallIsItsDiameter) {
    TriangleMesh ball;
    addSphere(ball, 10, false);
    const std::vector<double> thickness = thinnestWalls(ball, kShares);
    ASSERT_EQ(thickness.size(), 3u);
    for (const double t : thickness) EXPECT_NEAR(t, 20, 0.1);
}

TEST(WallThickness, IsNothingForASheet) {
    TriangleMesh sheet;
    sheet.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    EXPECT_THAT(thinnestWalls(sheet, kShares), IsEmpty());
}

InsideVoxels box(std::array<std::int64_t, 3> size, std::array<std::int64_t, 3> low,
                 std::array<std::int64_t, 3> high) {
    InsideVoxels voxels;
    voxels.size = size;
    voxels.inside.assign(static_cast<std::size_t>(size[0] * size[1] * size[2]), 0);
    for (auto z = low[2]; z <= high[2]; ++z)
        for (auto y = low[1]; y <= high[1]; ++y)
            for (auto x = low[0]; x <= high[0]; ++x) voxels.inside[voxels.index(x, y, z)] = 1;
    return voxels;
}

TEST(VoxelFacts, OfBoxesAreWhatCountingByHandGives) {
    const VoxelFacts one = factsOf(box({5, 5, 5}, {2, 2, 2}, {2, 2, 2}), kShares);
    EXPECT_EQ(one.faces, 6);
    EXPECT_EQ(one.cells, 8);
    EXPECT_THAT(one.walls, ElementsAre(1, 1, 1));
    const VoxelFacts cube = factsOf(box({5, 6, 7}, {1, 2, 3}, {2, 3, 4}), kShares);
    EXPECT_EQ(cube.faces, 24);
    EXPECT_EQ(cube.cells, 26) << "27 about the cube, of which the middle one is all inside";
    EXPECT_THAT(cube.low, ElementsAre(1, 2, 3));
    EXPECT_THAT(cube.high, ElementsAre(2, 3, 4));
    const VoxelFacts plate = factsOf(box({30, 30, 9}, {0, 0, 4}, {29, 29, 6}), kShares);
    EXPECT_EQ(plate.faces, 2 * 900 + 4 * 90) << "the image's border is a face";
    EXPECT_THAT(plate.walls, ElementsAre(3, 3, 3));
}

TEST(VoxelFacts, OfNothingHaveNoWalls) {
    const VoxelFacts nothing = factsOf(box({4, 4, 4}, {1, 1, 1}, {0, 0, 0}), kShares);
    EXPECT_EQ(nothing.faces, 0);
    EXPECT_THAT(nothing.walls, IsEmpty());
    EXPECT_GT(nothing.low[0], nothing.high[0]);
}

TEST(VoxelFacts, LongRunsCountAs255) {
    const VoxelFacts block = factsOf(box({260, 260, 260}, {0, 0, 0}, {259, 259, 259}), kShares);
    EXPECT_THAT(block.walls, ElementsAre(255, 255, 255));
}

}  // namespace
}  // namespace isowave::lod
