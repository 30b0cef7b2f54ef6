#include "hold/solid_limits.h"

#include <gtest/gtest.h>

#include "polygonize/fields.h"

namespace isowave {
namespace {

using testing::fieldFromDistance;
using testing::sphere;
using testing::torus;

TEST(SolidLimits, AllowWhatIsNotGivenAndNoMoreThanIs) {
    EXPECT_TRUE(SolidLimits{}.allow({7, 8, 9}));
    EXPECT_TRUE((SolidLimits{.handles = 8}.allow({7, 8, 9})));
    EXPECT_FALSE((SolidLimits{.handles = 7}.allow({7, 8, 9})));
    EXPECT_FALSE((SolidLimits{.parts = 6, .handles = 8}.allow({7, 8, 9})));
    EXPECT_FALSE((SolidLimits{.cavities = 0}.allow({7, 8, 9})));
}

TEST(SolidLimits, CountTheMeshWithoutSpecks) {
    EXPECT_EQ(meshedCounts(fieldFromDistance(16, torus(8, 3)), 1, 0), (SolidCounts{1, 1, 0}));
    const auto ballAndSpeck = fieldFromDistance(16, [](const openvdb::Vec3d& x) {
        return std::min(sphere(6)(x), sphere(1.5, {12, 0, 0})(x));
    });
    EXPECT_EQ(meshedCounts(ballAndSpeck, 2, 0), (SolidCounts{2, 0, 0}));
    EXPECT_EQ(meshedCounts(ballAndSpeck, 2, 30), (SolidCounts{1, 0, 0}));
}

}  // namespace
}  // namespace isowave
