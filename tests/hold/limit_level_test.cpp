#include "hold/limit_level.h"

#include <gtest/gtest.h>

#include "isowave/measure.h"
#include "polygonize/fields.h"
#include "polygonize/polygonize.h"

namespace isowave {
namespace {

using testing::fieldFromDistance;
using testing::torus;

LevelReport counted(const BSplineField& field) {
    LevelReport report;
    report.topology = topologyOf(polygonize(field));
    return report;
}

TEST(LimitLevel, TakesTheLowerOfOptionAndLevelBefore) {
    LevelOptions options;
    options.maxGenus = 3;
    EXPECT_FALSE(limitsOf(options).parts);
    EXPECT_EQ(limitsOf(options).handles, 3);
    const SolidLimits limits = limitsOf(options, SolidCounts{2, 1, 0});
    EXPECT_EQ(limits.parts, 2);
    EXPECT_EQ(limits.handles, 1);
    EXPECT_EQ(limits.cavities, 0);
    EXPECT_EQ(limitsOf(options, SolidCounts{2, 7, 0}).handles, 3);
    EXPECT_FALSE(limitsOf({}).any());
}

TEST(LimitLevel, TellsOfItsEdits) {
    BSplineField field = fieldFromDistance(16, torus(5, 3.4));
    LevelReport report = counted(field);
    EXPECT_EQ(limitLevel(field, 1, {.handles = 0}, 0, report, {}), "");
    ASSERT_EQ(report.edits.size(), 1u);
    EXPECT_TRUE(report.edits[0].fill);
    EXPECT_EQ(report.edits[0].what, SolidFeature::handle);
    EXPECT_GT(report.edits[0].volume, 0);
}

TEST(LimitLevel, SaysWhatIsMissed) {
    BSplineField field = fieldFromDistance(16, torus(8, 3));
    LevelReport report = counted(field);
    report.level = 2;
    Progress progress;
    std::string said;
    progress.remark = [&](std::string_view line) { said = line; };
    const std::string why =
        limitLevel(field, 1, {.parts = 0}, 0, report, progress);  // the largest part stays
    EXPECT_FALSE(report.limitsMissed);
    missLimits(report, why, progress);
    ASSERT_TRUE(report.limitsMissed);
    EXPECT_EQ(report.limitsMissed->find("1 part where 0 are allowed; 0 cuts and fills made, "), 0u)
        << *report.limitsMissed;
    EXPECT_EQ(said, "level 2: limits on the topology are missed: " + *report.limitsMissed);
}

}  // namespace
}  // namespace isowave
