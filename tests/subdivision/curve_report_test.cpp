// Whole files of curves: levels, errors, what is too short.
#include "subdivision/curves/curve_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "subdivision/curves/curve.h"
#include "subdivision/curves/curve_files.h"
#include "tests/subdivision/refusal.h"

namespace isowave::subdivision {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A circle of 64 points with a spike, and a triangle.
std::vector<Polyline> circleAndTriangle() {
    Polyline circle{2, true, {}}, triangle{2, true, {0, 0, 1, 0, 1, 1}};
    for (int k = 0; k < 64; ++k)
        for (const double x : {std::cos(M_PI * k / 32), std::sin(M_PI * k / 32) + (k == 5)})
            circle.coordinates.push_back(x);
    return {circle, triangle};
}

TEST(CurveReport, OfTwoCurvesHoldsEveryLevelAndSaysThatOneIsTooShort) {
    const CurveReport report =
        reportCurves(circleAndTriangle(), {.levels = 3, .threshold = 0.01, .compare = true});
    ASSERT_EQ(report.curves.size(), 2u);
    EXPECT_THAT(report.curves[0].points, ElementsAre(64, 32, 16, 8));
    EXPECT_THAT(report.curves[1].points, ElementsAre(3, 2, 1));
    EXPECT_EQ(report.tooShort, 1u);
    EXPECT_LT(report.curves[0].error[0], 1e-12);
    EXPECT_LT(report.curves[0].error[1], report.curves[0].error[3]);
    EXPECT_LT(report.curves[0].detailsLeft, report.curves[0].details);
    EXPECT_GT(report.curves[0].thresholdError, 0);
    EXPECT_LT(report.curves[0].compared.at("dlg-refined"), report.curves[0].compared.at("dlg-trial"));
    ASSERT_EQ(report.atLevel.size(), 4u);
    EXPECT_EQ(report.atLevel[2][0].size(), 16u);
    EXPECT_EQ(report.atLevel[3][1].size(), 1u) << "the coarsest it has";
    EXPECT_EQ(report.smooth[0].size(), 64u);
    EXPECT_EQ(report.thresholded.size(), 2u);
}

TEST(CurveReport, ResamplesKeepsAndTakesMasks) {
    const CurveReport kept =
        reportCurves(circleAndTriangle(), {.scheme = "cubic", .levels = 2, .resample = 50, .keep = 10});
    EXPECT_THAT(kept.curves[1].points, ElementsAre(50, 25, 13));
    EXPECT_EQ(kept.curves[0].detailsLeft, 10u);
    EXPECT_EQ(reportCurves(circleAndTriangle(), {.mask = "1/4 3/4 3/4 1/4", .levels = 1}).scheme, "mask-4");
}

TEST(CurveReport, RefusesWhatCannotBe) {
    const auto curves = circleAndTriangle();
    EXPECT_THAT(complaint([&] { reportCurves(curves, {.levels = 9}); }), HasSubstr("need at least 257"));
    EXPECT_THAT(complaint([&] { reportCurves(curves, {.scheme = "x"}); }), HasSubstr("dlg-refined"));
    const Polyline three{2, false, {0, 0, 1, 0, 1, 1}};
    EXPECT_THAT(complaint([&] { reportCurves({three}, {}); }),
                HasSubstr("has 3 points; 6 levels of an open dlg-refined curve need at least 34"));
}

TEST(CurveReport, OfACoastComesBackAndRefinementPays) {
    const CurveFile coast = CurveFile::read(ISOWAVE_TEST_DATA "/coast/great_britain.txt");
    const CurveReport report = reportCurves(coast.curves(), {.keep = 500, .compare = true});
    const auto& curve = report.curves[0];
    EXPECT_THAT(curve.points, ElementsAre(4096, 2048, 1024, 512, 256, 128, 64));
    EXPECT_LT(curve.roundTrip, 1e-12);
    EXPECT_EQ(curve.detailsLeft, 500u);
    EXPECT_LT(curve.compared.at("dlg-refined"), curve.compared.at("dlg-trial"));
    EXPECT_EQ(report.tooShort, 0u);
}

TEST(CurveTransform, IsTheFiltersOfTheNamedScheme) {
    const Polyline circle = circleAndTriangle()[0];
    const CurveTransform transform("cubic-7", true);
    EXPECT_EQ(transform.mostLevels(64), 6);
    CurveLevels levels = transform.decompose(circle, 3);
    EXPECT_LT(l2Distance(transform.reconstruct(levels), circle), 1e-13);
    EXPECT_EQ(transform.reconstruct(levels, 2).size(), 16u);
    threshold(levels, INFINITY);
    EXPECT_EQ(transform.reconstruct(levels).coordinates, transform.subdivided(levels, 3).coordinates);
    EXPECT_EQ(CurveTransform::ofMask("1/8 1/2 3/4 1/2 1/8", 7).decompose(circle, 3).coarse.coordinates,
              levels.coarse.coordinates);
    EXPECT_THAT(complaint([] { CurveTransform("best", true); }), HasSubstr("dlg-trial"));
}

}  // namespace
}  // namespace isowave::subdivision
