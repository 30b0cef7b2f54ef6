#include "polygonize/refit.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"

namespace isowave {
namespace {

using namespace isowave::testing;

BSplineField ballOf(double radius) { return fieldFromDistance(16, sphere(radius), oblique()); }
std::vector<SurfaceSample> surfaceOf(double radius) {
    return surfaceSamples(polygonize(ballOf(radius), {.refine = 2}));
}
double volumeOf(const BSplineField& field) { return topologyOf(polygonize(field, {.refine = 2})).volume; }

bool sameValues(const BSplineField& a, const BSplineField& b) {
    for (auto value = a.controlPoints->cbeginValueAll(); value; ++value)
        if (*value != b.controlPoints->tree().getValue(value.getCoord())) return false;
    return a.controlPointCount() == b.controlPointCount();
}

TEST(Refit, MovesTheZeroSetOntoTheSurface) {
    const double wanted = volumeOf(ballOf(9.3));
    const BSplineField level = ballOf(9);
    ASSERT_LT(volumeOf(level), 0.92 * wanted);
    EXPECT_NEAR(volumeOf(refitted(level, surfaceOf(9.3))) / wanted, 1, 4e-3);
}

TEST(Refit, LeavesWhatIsFartherAwayThanItsReach) {
    const BSplineField level = ballOf(9);  // K = 4 voxels away from the surface
    EXPECT_TRUE(sameValues(refitted(level, surfaceOf(9 + 2.1)), level));
    EXPECT_FALSE(sameValues(refitted(level, surfaceOf(9 + 1.9)), level));
}

TEST(Refit, LeavesItsInputAsItIs) {
    const BSplineField level = ballOf(9), copy = ballOf(9);
    refitted(level, surfaceOf(9.3));
    EXPECT_TRUE(sameValues(level, copy));
}

TEST(Refit, IsTheSameForEveryNumberOfThreads) {
    const BSplineField level = ballOf(9);
    const std::vector<SurfaceSample> surface = surfaceOf(9.3);
    const auto withThreads = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return refitted(level, surface, {.sweeps = 2});
    };
    const BSplineField one = withThreads(1);
    EXPECT_TRUE(sameValues(withThreads(2), one));
    EXPECT_TRUE(sameValues(withThreads(4), one));
}

}  // namespace
}  // namespace isowave
