// Limit positions of curves and reliefs: known masks exactly, and every scheme against subdivision itself.
#include "subdivision/filters/limit_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "isowave/error.h"
#include "subdivision/curves/curve.h"
#include "subdivision/curves/curve_limit.h"
#include "subdivision/filters/masks.h"
#include "subdivision/lattice/surface_limit.h"
#include "tests/subdivision/refusal.h"

namespace isowave::subdivision {
namespace {

using testing::HasSubstr;

std::vector<Rational> weightsOf(const Diagram& mask) {
    std::vector<Rational> weights;
    for (const auto& [node, weight] : mask) weights.push_back(weight);
    return weights;
}

std::vector<Rational> over(int denominator, const std::vector<int>& values) {
    std::vector<Rational> weights;
    for (const int v : values) weights.emplace_back(Rational(v, denominator));
    return weights;
}

Mask ofTaps(const char* taps) { return customMask(Lattice::Line, parseRationals(taps)); }

std::vector<double> random(std::size_t count, unsigned seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<double> values(count);
    for (double& v : values) v = uniform(engine);
    return values;
}

// ---- masks ----

// Values of the uniform B-splines at their middle and at whole steps from there (de Boor, "A practical guide to splines").
TEST(LimitMask, OfBSplinesAreTheirKnownValues) {
    EXPECT_EQ(weightsOf(limitMask(bspline(1))), over(1, {1}));
    EXPECT_EQ(weightsOf(limitMask(bspline(2))), over(8, {1, 6, 1}));
    EXPECT_EQ(weightsOf(limitMask(bspline(3))), over(6, {1, 4, 1}));
    EXPECT_EQ(weightsOf(limitMask(bspline(4))), over(384, {1, 76, 230, 76, 1}));
    EXPECT_EQ(weightsOf(limitMask(bspline(5))), over(120, {1, 26, 66, 26, 1}));
    EXPECT_EQ(weightsOf(limitMask(bspline(7))), over(5040, {1, 120, 1191, 2416, 1191, 120, 1}));
}

TEST(LimitMask, OfAMaskThatInterpolatesIsOne) {
    EXPECT_EQ(limitMask(namedMask("dlg")), Diagram::delta({}));
    EXPECT_EQ(limitMask(namedMask("butterfly")), Diagram::delta({}));
}

TEST(LimitMask, OfLoopLikeIsTheEigenvectorOfItsStar) {
    for (const auto& [alpha, gamma] :
         {std::pair{Rational(1, 16), Rational(1, 8)}, std::pair{Rational(1, 20), Rational(1, 10)},
          std::pair{Rational(0), Rational(1, 16)}}) {
        const Rational w = 2 * alpha / (1 - 2 * gamma);
        const Diagram mask = limitMask(loopLike(alpha, gamma));
        EXPECT_EQ(mask[{}], 1 / (1 + 6 * w));
        for (const Node n : ring(Lattice::Triangular, {}, 1)) EXPECT_EQ(mask[n], w / (1 + 6 * w));
        EXPECT_EQ(mask.sum(), 1);
    }
}

TEST(LimitMask, SaysWhyThereIsNone) {
    EXPECT_THAT(whyNoLimit(ofTaps("1/4 1/2 1/4")), HasSubstr("must add up to 1; some add up to 1/2"));
    EXPECT_THAT(whyNoLimit(ofTaps("1 1")), HasSubstr("not seen to converge"));     // steps, not a curve
    EXPECT_THAT(whyNoLimit(ofTaps("2 1 -1")), HasSubstr("not seen to converge"));  // grows
    EXPECT_THAT(whyNoLimit(loopLike(Rational(1, 2), Rational(0))), HasSubstr("not seen to converge"));
    EXPECT_EQ(whyNoLimit(namedMask("loop")), "");
    EXPECT_THAT(complaint([] { limitMask(ofTaps("1/6 2/3 5/6 1/3")); }), HasSubstr("2/3, has a denominator"));
}

// ---- curves ----

std::vector<double> subdividedOnce(const std::vector<double>& points, const CurveFilters& filters) {
    const std::size_t n = points.size() / 2, fine = filters.fineSize(n);
    std::vector<double> result(2 * fine);
    applyBank(filters.maps(n).p, 2, points.data(), n, result.data(), fine, false);
    return result;
}

// The polygon of 2D points at a place between them, counted in points; closed polygons come round.
Vec3 onPolygon(const std::vector<double>& points, double place) {
    const auto n = static_cast<std::ptrdiff_t>(points.size() / 2);
    const auto below = static_cast<std::ptrdiff_t>(std::floor(place));
    const double t = place - static_cast<double>(below);
    const auto at = [&](std::ptrdiff_t k) {
        k = ((k % n) + n) % n;
        return Vec3{points[static_cast<std::size_t>(2 * k)], points[static_cast<std::size_t>(2 * k + 1)], 0};
    };
    return (1 - t) * at(below) + t * at(below + 1);
}

constexpr int kTimes = 11;      // subdivisions of curves
constexpr double kNear = 1e-6;  // polygons near curves as 4^-k: seen 1.6e-7

void expectClosedLimits(const CurveScheme& scheme, double centre) {
    const CurveFilters filters(scheme, true);
    for (const std::size_t n : {3u, 4u, 7u, 12u}) {
        const Polyline curve{2, true, random(2 * n, 5)};
        const Polyline limit = CurveLimit(scheme).of(curve);
        std::vector<double> fine = curve.coordinates;
        for (int k = 0; k < kTimes; ++k) fine = subdividedOnce(fine, filters);
        for (std::size_t i = 0; i < n; ++i) {
            // Coarse point i stands at i + centre, fine point j at (j + centre)/2^k.
            const double place = std::ldexp(double(i) + centre, kTimes) - centre;
            const Vec3 expected = onPolygon(fine, place);
            EXPECT_NEAR(limit.coordinates[2 * i], expected.x, kNear) << scheme.name << " " << n << " " << i;
            EXPECT_NEAR(limit.coordinates[2 * i + 1], expected.y, kNear)
                << scheme.name << " " << n << " " << i;
        }
    }
}

TEST(CurveLimits, OfClosedCurvesAreWhereElevenSubdivisionsTakeThem) {
    for (const auto& name : curveSchemeNames())
        expectClosedLimits(curveScheme(name), name.starts_with("chaikin") ? 0.5 : 0);
    expectClosedLimits(maskScheme("1/8 1/2 3/4 1/2 1/8", 0), 0);
    expectClosedLimits(maskScheme("1/32 3/16 15/32 5/8 15/32 3/16 1/32", 0), 0);  // the quintic B-spline
    expectClosedLimits(maskScheme("1/8 5/8 7/8 3/8", 0), 0.75);                   // one-sided
}

double greville(int degree, std::size_t n, std::size_t i) {
    double sum = 0;
    for (int r = 1; r <= degree; ++r) sum += std::clamp(double(i) + r - degree, 0.0, double(n) - degree);
    return sum / degree;
}

// The place of u in a polygon whose point j stands at `at`(j).
template <class At>
double placeOf(double u, std::size_t n, At at) {
    std::size_t j = 0;
    while (j + 2 < n && at(j + 1) < u) ++j;
    return double(j) + (u - at(j)) / (at(j + 1) - at(j));
}

TEST(CurveLimits, OfOpenCurvesAreOnTheCurveAtTheirGrevilleAbscissae) {
    for (const auto* name : {"chaikin-4", "cubic-7"}) {
        const CurveScheme scheme = curveScheme(name);
        const CurveFilters filters(scheme, false);
        const int degree = scheme.degree;
        for (auto n = static_cast<std::size_t>(degree) + 1; n <= 9; ++n) {
            const Polyline curve{2, false, random(2 * n, 6)};
            const Polyline limit = CurveLimit(scheme).of(curve);
            std::vector<double> fine = curve.coordinates;
            for (int k = 0; k < kTimes; ++k) fine = subdividedOnce(fine, filters);
            const std::size_t m = fine.size() / 2;
            for (std::size_t i = 0; i < n; ++i) {
                const double place = placeOf(std::ldexp(greville(degree, n, i), kTimes), m,
                                             [&](std::size_t j) { return greville(degree, m, j); });
                const Vec3 expected = onPolygon(fine, place);
                EXPECT_NEAR(limit.coordinates[2 * i], expected.x, kNear) << name << " " << n << " " << i;
                EXPECT_NEAR(limit.coordinates[2 * i + 1], expected.y, kNear) << name << " " << n << " " << i;
            }
            EXPECT_EQ(limit.coordinates[0], curve.coordinates[0]);
            EXPECT_EQ(limit.coordinates.back(), curve.coordinates.back());
        }
    }
}

TEST(CurveLimits, InsideAnOpenCurveAreThoseOfAClosedOne) {
    for (const auto* name : {"chaikin-4", "cubic-7"}) {
        const CurveLimit limit(curveScheme(name));
        const std::vector<double> points = random(40, 8);
        const Polyline open = limit.of({2, false, points}), closed = limit.of({2, true, points});
        for (std::size_t k = 8; k < 32; ++k)
            EXPECT_NEAR(open.coordinates[k], closed.coordinates[k], 1e-15) << name;
    }
}

TEST(CurveLimits, OfTheFourPointRuleAreThePoints) {
    const std::vector<double> points = random(20, 9);
    for (const bool closed : {false, true})
        EXPECT_EQ(CurveLimit(curveScheme("dlg-refined")).of({2, closed, points}).coordinates, points);
}

TEST(CurveLimits, AreRefusedForShortOpenCurvesAndMasksWithout) {
    EXPECT_THAT(complaint([] {
                    CurveTransform("cubic-7", false).limit({2, false, {0, 0, 1, 1, 2, 0}});
                }),
                HasSubstr("has 3 points; limit positions of an open cubic-7 curve need 4"));
    EXPECT_THAT(complaint([] { CurveLimit(maskScheme("2 1 -1", 0)); }), HasSubstr("has no limit positions"));
    EXPECT_THAT(complaint([] {
                    CurveLimit(maskScheme("1/4 3/4 3/4 1/4", 0)).of({2, false, {0, 0, 1, 1, 2, 0}});
                }),
                HasSubstr("is for closed curves"));
}

TEST(CurveLimits, StandInAReportWhoseErrorsAreThoseOfControlPoints) {
    const std::vector<Polyline> curves{{2, true, random(64, 3)}, {2, false, {0, 0, 1, 1, 2, 0}}};
    CurveReportOptions options{.scheme = "cubic-7", .levels = 2, .threshold = 0.1};
    const CurveReport control = reportCurves(curves, options);
    options.positions = Positions::limit;
    const CurveReport limit = reportCurves(curves, options);
    const CurveLimit rule(curveScheme("cubic-7"));
    EXPECT_EQ(limit.positions, Positions::limit);
    EXPECT_EQ(limit.withoutLimit, 1u);
    EXPECT_EQ(limit.curves[0].error, control.curves[0].error);
    for (std::size_t k = 0; k < control.atLevel.size(); ++k) {
        EXPECT_EQ(limit.atLevel[k][0].coordinates, rule.of(control.atLevel[k][0]).coordinates);
        EXPECT_EQ(limit.atLevel[k][1].coordinates, control.atLevel[k][1].coordinates);
    }
    EXPECT_EQ(limit.smooth[0].coordinates, rule.of(control.smooth[0]).coordinates);
    EXPECT_EQ(limit.thresholded[0].coordinates, rule.of(control.thresholded[0]).coordinates);
}

// ---- reliefs ----

// Subdivided so often without details.
SurfaceField subdividedFar(const SurfaceField& field, const SurfaceScheme& scheme, int times) {
    SurfaceLevels levels{scheme.name, field, {}};
    Patch patch = field.patch;
    std::vector<std::vector<double>> details;
    for (int k = 0; k < times; ++k) {
        details.emplace_back(patch.subdivided().size() - patch.size(), 0.0);
        patch = patch.subdivided();
    }
    levels.details.assign(details.rbegin(), details.rend());
    SurfaceFilters filters(scheme);
    return subdivided(levels, filters, times);
}

TEST(SurfaceLimits, AreWhereEightSubdivisionsTakeTheNodes) {
    constexpr int kHalvings = 8;
    for (const auto* name : {"loop-1", "butterfly-trivial", "loop-like:1/20,1/10"}) {
        const SurfaceScheme scheme = surfaceScheme(name);
        for (const Patch& patch : {Patch::parallelogram(4, 3), Patch::hexagon(2), Patch::torus(4, 4)}) {
            const SurfaceField field{patch, 1, random(patch.size(), 4)};
            const SurfaceField limit = SurfaceLimit(scheme).of(field);
            const SurfaceField far = subdividedFar(field, scheme, kHalvings);
            for (const Node node : patch.nodes())
                EXPECT_NEAR(limit.values[patch.index(node)],
                            far.values[far.patch.index((1 << kHalvings) * node)], 1e-4)  // seen 2.9e-5
                    << name << ", " << patch.name() << " " << node.x << " " << node.y;
        }
    }
}

TEST(SurfaceLimits, AreRefusedWhereLoopLikeDoesNotConverge) {
    const Grid grid{5, 5, 1, random(25, 2)};
    const ReliefReportOptions options{
        .scheme = "loop-like:1/2,0", .levels = 1, .positions = Positions::limit};
    EXPECT_THAT(complaint([&] { reportRelief(grid, options); }), HasSubstr("has no limit positions"));
}

TEST(SurfaceLimits, StandInAReportBesideTheReconstruction) {
    const Grid grid{13, 10, 1, random(130, 2)};
    ReliefReportOptions options{.scheme = "loop-3", .levels = 2};
    const ReliefReport control = reportRelief(grid, options);
    options.positions = Positions::limit;
    const ReliefReport limit = reportRelief(grid, options);
    EXPECT_EQ(limit.reconstructed.values, control.levels[0].heights.values);
    EXPECT_EQ(control.reconstructed.values, control.levels[0].heights.values);
    EXPECT_EQ(limit.levels[1].suppressedRms, control.levels[1].suppressedRms);
    for (std::size_t k = 0; k < control.levels.size(); ++k) {
        EXPECT_EQ(limit.levels[k].heights.rows, control.levels[k].heights.rows);
        EXPECT_NE(limit.levels[k].heights.values, control.levels[k].heights.values);
        EXPECT_EQ(limit.levels[k].heights.values.front(),
                  control.levels[k].heights.values.front());  // a corner
    }
}

}  // namespace
}  // namespace isowave::subdivision
