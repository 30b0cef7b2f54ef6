// The workflow linked without simplify/: all meshes are there, distances are not, and what cannot be had says so.
#include "tests/lod/solids.h"

namespace isowave::lod_test {
namespace {

using testing::HasSubstr;

template <class Error>
std::string refusalOf(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

Solid ring() { return open(ringMesh(), {.voxels = 40}); }

TEST(WithoutSimplify, LevelsAreMadeButNotMeasuredAgainstLevelZero) {
    EXPECT_FALSE(canMeasureDistances());
    const Ladder ladder =
        makeLadder(ring(), {.levels = StepRange{0, 2}, .hold = Holding::shift, .features = true});
    ASSERT_EQ(ladder.levels.size(), 3u);
    EXPECT_EQ(ladder.levels[0].report.maxToLevel0, 0);
    for (std::size_t i = 0; i < 3; ++i) {
        expectSound(topologyOf(ladder.levels[i].mesh));
        EXPECT_TRUE(ladder.levels[i].report.features);
        EXPECT_EQ(ladder.levels[i].report.maxToLevel0.has_value(), i == 0);
        EXPECT_EQ(ladder.levels[i].report.rmsFromLevel0.has_value(), i == 0);
    }
}

TEST(WithoutSimplify, WhatNeedsItNamesTheBuildOption) {
    EXPECT_THAT(refusalOf<UsageError>([] { makeLadder(ring(), {.refine = 2, .compact = true}); }),
                HasSubstr("--compact needs CGAL packages under the GPL"));
    EXPECT_THAT(refusalOf<UsageError>([] { makeBudget(ring(), {.triangles = {100}}); }),
                HasSubstr("-DISOWAVE_GPL=ON"));
    EXPECT_THAT(refusalOf<OperationError>([] { compareMeshes(ringMesh(), ringMesh()); }),
                HasSubstr("-DISOWAVE_GPL=ON"));
    EXPECT_THAT(refusalOf<OperationError>([] { countSelfIntersections(ringMesh()); }),
                HasSubstr("-DISOWAVE_GPL=ON"));
}

}  // namespace
}  // namespace isowave::lod_test
