// The promises of base/triangle.h and base/point_box.h.
#include "base/triangle.h"

#include <gtest/gtest.h>

#include "base/point_box.h"

namespace isowave {
namespace {

const TriangleMesh kTriangle{{{1, 1, 1}, {3, 1, 1}, {1, 4, 1}, {9, 9, 9}}, {{0, 1, 2}}, {}};

TEST(AreaNormal, IsTwiceTheAreaTowardsWhereTheTriangleRunsCounterClockwise) {
    EXPECT_EQ(areaNormal(kTriangle, {0, 1, 2}), (Vec3{0, 0, 6}));
    EXPECT_EQ(areaNormal(kTriangle, {0, 2, 1}), (Vec3{0, 0, -6}));
    EXPECT_EQ(areaNormal(kTriangle, {0, 0, 1}), (Vec3{0, 0, 0}));
}

TEST(PointBox, HoldsWhatTrianglesUse) {
    const PointBox box = boxAround(kTriangle);
    EXPECT_EQ(box.low, (Point{1, 1, 1}));
    EXPECT_EQ(box.high, (Point{3, 4, 1}));  // not the point that no triangle uses
    EXPECT_EQ(box.centre(), (Point{2, 2.5, 1}));
    EXPECT_EQ(box.extent(1), 3);
    EXPECT_TRUE(box.contains({3, 4, 1}));
    EXPECT_FALSE(box.contains({3, 4, 1.5}));
}

TEST(PointBox, OfNothingContainsNothing) {
    EXPECT_FALSE(PointBox().contains({0, 0, 0}));
    EXPECT_FALSE(boxAround({}).contains({0, 0, 0}));
}

}  // namespace
}  // namespace isowave
