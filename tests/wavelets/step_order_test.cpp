// The promises of isowave/solid.h (StepOrder) and step_order.h.
#include "wavelets/step_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace isowave::wavelets {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Voxel = std::array<double, 3>;

const StepOrder kFlat{{"xy", "xy"}};

TEST(StepOrder, HalvesShortEdgesUntilNoneIsHalfTheLongest) {
    const auto first = [](double x, double y, double z) { return StepOrder::forVoxels({x, y, z}).first; };
    EXPECT_THAT(first(0.5, 0.5, 2.5), ElementsAre("xy", "xy"));    // 2 2 2.5
    EXPECT_THAT(first(0.5, 0.5, 1.5), ElementsAre("xy"));          // 1 1 1.5
    EXPECT_THAT(first(2, 2, 1), ElementsAre("z"));                 // 2 2 2
    EXPECT_THAT(first(2.1, 1, 1), ElementsAre("yz"));              // 2.1 2 2
    EXPECT_THAT(first(1, 1.2, 2.2), ElementsAre("xy"));            // 2 2.4 2.2: x alone would make 2 1.2 2.2
    EXPECT_THAT(first(1, 1.9, 2.2), ElementsAre("x"));             // 2 1.9 2.2
    EXPECT_THAT(first(0.1, 0.5, 1), ElementsAre("x", "x", "xy"));  // .4 .5 1, then .8 1 1
    EXPECT_THAT(first(8, 1, 8), ElementsAre("y", "y", "y"));
}

TEST(StepOrder, TakesAllAxesInTurnWhereEdgesDifferByLessThanTwo) {
    for (const Voxel& voxel :
         {Voxel{1, 1, 1}, Voxel{0.7, 1, 1.04}, Voxel{0.957, 0.957, 1.5}, Voxel{1.99, 1, 1.3}})
        EXPECT_THAT(StepOrder::forVoxels(voxel).first, IsEmpty());
}

TEST(StepOrder, ByAFactorOfOneComesAsNearToACubeAsItCan) {
    const auto first = [](double x, double y, double z) { return StepOrder::forVoxels({x, y, z}, 1).first; };
    EXPECT_THAT(first(0.957, 0.957, 1.5), ElementsAre("xy"));  // 1.91 1.91 1.5
    EXPECT_THAT(first(1.5, 1, 1), ElementsAre("yz"));          // 1.5 2 2
    EXPECT_THAT(first(1, 1.1, 1.6), ElementsAre("xy"));        // 2 2.2 1.6: x alone would make 2 1.1 1.6
    EXPECT_THAT(first(1, 1, 1.4), IsEmpty());                  // 2 2 1.4 would be farther
    EXPECT_THAT(first(1, 1.26, 1.587), IsEmpty());  // thirds of an octave: any halving leaves 1.587
    EXPECT_THAT(first(1, 1, 1), IsEmpty());
}

TEST(StepOrder, RoundingOfObliqueAxesDoesNotChangeIt) {
    EXPECT_THAT(StepOrder::forVoxels({0.5, 0.5 * (1 + 1e-12), 1 - 1e-12}).first, ElementsAre("xy"));
    EXPECT_THAT(StepOrder::forVoxels({1 + 1e-12, 2, 4}).first, StepOrder::forVoxels({1, 2, 4}).first);
}

TEST(StepOrder, IsTheSameInAnyUnit) {
    std::mt19937 random(5);
    for (int i = 0; i < 500; ++i) {
        Voxel voxel;
        for (double& edge : voxel) edge = std::exp2(static_cast<double>(random() % 600) / 100);
        const Voxel micrometres{1000 * voxel[0], 1000 * voxel[1], 1000 * voxel[2]};
        EXPECT_EQ(StepOrder::forVoxels(voxel), StepOrder::forVoxels(micrometres));
    }
}

double ratioOf(const Voxel& v) {
    return *std::max_element(v.begin(), v.end()) / *std::min_element(v.begin(), v.end());
}

Voxel halvedOn(Voxel voxel, const std::array<int, 3>& times) {
    for (std::size_t a = 0; a < 3; ++a) voxel[a] = std::ldexp(voxel[a], times[a]);
    return voxel;
}

// Every proper subset of the axes, not only those that the rounds choose among.
double bestRatioAfter(const Voxel& voxel) {
    double best = ratioOf(voxel);
    for (int set = 1; set < 7; ++set)
        best = std::min(best, ratioOf(halvedOn(voxel, {set & 1, set >> 1 & 1, set >> 2 & 1})));
    return best;
}

TEST(StepOrder, EndsBelowTheFactorOrWhereNoHalvingComesNearer) {
    std::mt19937 random(7);
    for (int i = 0; i < 2000; ++i) {
        Voxel voxel;
        for (double& edge : voxel) edge = std::exp2(static_cast<double>(random() % 6000) / 1000);
        for (const double factor : {1.0, 1.5, 2.0}) {
            const StepOrder order = StepOrder::forVoxels(voxel, factor);
            const int levels = static_cast<int>(order.first.size());
            double ratio = ratioOf(voxel);
            for (int level = 1; level <= levels; ++level) {
                EXPECT_GE(ratio, factor * (1 - 1e-6));
                const double now = ratioOf(halvedOn(voxel, order.halvings(order.stepOf(level))));
                EXPECT_LT(now, ratio);
                ratio = now;
            }
            const Voxel end = halvedOn(voxel, order.halvings(order.stepOf(levels)));
            EXPECT_TRUE(ratio < factor || bestRatioAfter(end) >= ratio * (1 - 1e-6)) << ratio;
            EXPECT_LT(ratio, 2 + 1e-5);
            EXPECT_LT(*std::max_element(end.begin(), end.end()),
                      2 * *std::max_element(voxel.begin(), voxel.end()));
        }
    }
}

TEST(StepOrder, FromLevelToLevelNoEdgeIsMoreThanTwiceAsLong) {
    std::mt19937 random(11);
    for (int i = 0; i < 500; ++i) {
        Voxel voxel;
        for (double& edge : voxel) edge = std::exp2(static_cast<double>(random() % 6000) / 1000);
        const StepOrder order = StepOrder::forVoxels(voxel);
        for (int level = 0; level < 12; ++level) {
            const std::array<int, 3> now = order.halvings(order.stepOf(level)),
                                     next = order.halvings(order.stepOf(level + 1));
            int halved = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                EXPECT_LE(next[a] - now[a], 1);
                halved += next[a] - now[a];
            }
            EXPECT_GE(halved, 1);
        }
    }
}

TEST(StepOrder, WithoutFirstLevelsLevelLIsStepThreeL) {
    const StepOrder order;
    for (int step = 0; step < 40; ++step) {
        EXPECT_EQ(order.axisAfter(step), step % 3);
        EXPECT_EQ(order.levelUpTo(step), step / 3);
        EXPECT_EQ(order.levelOf(step), step % 3 == 0 ? std::optional(step / 3) : std::nullopt);
        EXPECT_EQ(order.halvings(step), (std::array{(step + 2) / 3, (step + 1) / 3, step / 3}));
    }
    for (const double voxel : {1.0, 1.99, 2.0, 3.0, 4.0, 31.9})
        EXPECT_EQ(order.levelOfVoxel(voxel), static_cast<int>(std::floor(std::log2(voxel)))) << voxel;
}

TEST(StepOrder, CountsTheFirstLevelsAndAllAfterThem) {
    std::string axes;
    for (int step = 0; step < 10; ++step) axes += "xyz"[kFlat.axisAfter(step)];
    EXPECT_EQ(axes, "xyxyxyzxyz");
    std::vector<int> steps, levels;
    for (int level = 0; level < 5; ++level) steps.push_back(kFlat.stepOf(level));
    for (const int step : steps) levels.push_back(kFlat.levelOf(step).value_or(-1));
    EXPECT_THAT(steps, ElementsAre(0, 2, 4, 7, 10));
    EXPECT_THAT(levels, ElementsAre(0, 1, 2, 3, 4));
    for (const int between : {1, 3, 5, 6, 8, 9}) EXPECT_EQ(kFlat.levelOf(between), std::nullopt) << between;
    EXPECT_EQ(kFlat.levelUpTo(1), 0);
    EXPECT_EQ(kFlat.levelUpTo(6), 2);
    EXPECT_EQ(kFlat.halvings(7), (std::array{3, 3, 1}));
    EXPECT_EQ(kFlat.levelOfVoxel(4), 2);
    EXPECT_EQ(StepOrder({{"z"}}).levelOfVoxel(2), 1);
}

TEST(StepOrder, ComesBackFromItsText) {
    for (const StepOrder& order : {StepOrder{}, kFlat, StepOrder{{"z"}}, StepOrder{{"zx", "xyz", "zy"}}})
        EXPECT_EQ(orderOf(textOf(order)), order) << textOf(order);
    EXPECT_EQ(textOf(kFlat), "xy xy");
    for (const std::string bad :
         {" ", "xy  xy", " xy", "xy ", "xw", "XY", "xy,xy", "1", "xx", "xy yzy", "zxyz"})
        EXPECT_EQ(orderOf(bad), std::nullopt) << bad;
    StepOrder most{std::vector<std::string>(kMostHalvings, "xyz")};
    EXPECT_EQ(orderOf(textOf(most)), most);
    most.first.push_back("x");
    EXPECT_EQ(orderOf(textOf(most)), std::nullopt);
}

TEST(StepOrder, LevelsThatNoSolidHasAreNumbersStill) {
    constexpr int kLast = std::numeric_limits<int>::max(), kNoLevel = 1 << 30;
    for (const StepOrder& order : {StepOrder{}, kFlat}) {
        for (const int level : {kLast, 2'000'000'000, 1'000'000'000, kNoLevel / 3 + 1})
            EXPECT_EQ(order.stepOf(level), kNoLevel) << level;
        const int level = order.levelUpTo(kNoLevel - 1);
        EXPECT_LT(order.stepOf(level), kNoLevel);
        EXPECT_EQ(order.levelOf(order.stepOf(level)), level);
        EXPECT_EQ(order.halvings(order.stepOf(level)),
                  (std::array{level, level, level - int(order.first.size())}));
    }
}

TEST(StepOrder, AnInfiniteVoxelIsTheLargestNumber) {
    constexpr double kLargest = std::numeric_limits<double>::max(),
                     kInfinite = std::numeric_limits<double>::infinity();
    for (const StepOrder& order : {StepOrder{}, kFlat}) {
        EXPECT_EQ(order.levelOfVoxel(kInfinite), 1023);
        EXPECT_EQ(order.levelOfVoxel(kLargest), 1023);
        EXPECT_EQ(order.levelOfVoxel(kLargest / 2), 1022);
    }
}

TEST(StepOrder, OfTheThinnestVoxelsFitsIntoAFile) {
    const StepOrder order = StepOrder::forVoxels({1e-300, 1e-300, 1});
    EXPECT_EQ(orderOf(textOf(order)), order);
}

}  // namespace
}  // namespace isowave::wavelets
