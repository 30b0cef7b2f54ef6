// The promises of edit/edit.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "curves2d/contour.h"
#include "curves2d/file/pyramid_file.h"
#include "curves2d/fit.h"
#include "curves2d/ladder.h"
#include "curves2d/pyramid.h"
#include "curves2d/raster.h"
#include "curves2d/shapes.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

using testing::HasSubstr;

Polygon rectangle(double x0, double y0, double x1, double y1) {
    return {{{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}}};
}

Polygon disc(double x, double y, double r) {
    Ring ring;
    for (int i = 0; i < 360; ++i)
        ring.push_back({x + r * std::cos(i * M_PI / 180), y + r * std::sin(i * M_PI / 180)});
    return {{ring}};
}

// A disc of radius 40 pixels in world coordinates that are no whole pixels.
Input round(Fit method = Fit::distance) {
    return fitted(polygonInput({disc(7.3, -2.1, 40), rectangle(100, -60, 101, -59)}, {.pixels = 160}),
                  {.fit = method});
}

double areaOf(const Input& input) { return extractCurves(input.fitted->field).area(); }

RowField<float> withOneSign(const RowField<float>& field) { return transposed(transposed(field)); }

void expectSound(const Input& input, const std::string& name) {
    const RowField<float>& field = input.fitted->field;
    const RowField<float> back = withOneSign(field);
    ASSERT_EQ(field.rowNumbers(), back.rowNumbers()) << name;
    for (const auto& [number, row] : field.rows) EXPECT_TRUE(row == *back.find(number)) << name;
    const Bounds box = field.bounds();
    EXPECT_GE(box.first[0], -1) << name;
    EXPECT_GE(box.first[1], -1) << name;
    EXPECT_EQ(analyse(field).coarsest.controlPointCount(), 16) << name;
    EXPECT_EQ(pyramidBytes(readPyramid(pyramidBytes(input), "p")), pyramidBytes(input)) << name;
}

TEST(PlaneEdit, ChangesTheAreaByThatOfTheTool) {
    for (const Fit method : {Fit::distance, Fit::binary})
        for (int level = 0; level <= 2; ++level) {
            const std::string name = std::to_string(level);
            const Input before = round(method);
            const Polygon outside = rectangle(60, 5, 84.5, 31.25), within = rectangle(-10.2, -15, 14, 9.7);
            const Input more = edited(before, {false, {outside}, level}),
                        less = edited(before, {true, {within}, level});
            EXPECT_NEAR((areaOf(more) - areaOf(before)) / (24.5 * 26.25), 1, 0.03) << name;
            EXPECT_NEAR((areaOf(before) - areaOf(less)) / (24.2 * 24.7), 1, 0.03) << name;
            EXPECT_EQ(extractCurves(more.fitted->field).outerCount(),
                      extractCurves(before.fitted->field).outerCount() + 1);
            EXPECT_EQ(extractCurves(less.fitted->field).holeCount(), 1u);
            expectSound(more, name);
            expectSound(less, name);
        }
}

// Half of the tool lies in the disc: what comes out is a union, whose area is known.
TEST(PlaneEdit, IsAUnionAndADifference) {
    const Input before = round();
    // A rectangle as high as 20 that reaches from the disc's middle to 30 beyond its border.
    const Polygon bar = rectangle(7.3, -12.1, 7.3 + 70, 7.9);
    // The part of the bar in the disc: two circular halves of a strip, 20 sqrt(40^2 - 10^2)/2 + 40^2 asin(1/4).
    const double shared = 10 * std::sqrt(1500.0) + 1600 * std::asin(0.25), all = 20 * 70;
    EXPECT_NEAR(areaOf(edited(before, {false, {bar}, 0})) - areaOf(before), all - shared,
                0.01 * (all - shared));
    EXPECT_NEAR(areaOf(before) - areaOf(edited(before, {true, {bar}, 0})), shared, 0.01 * shared);
}

TEST(PlaneEdit, LeavesControlPointsAwayFromTheToolToTheBit) {
    for (const Fit method : {Fit::distance, Fit::binary})
        for (int level = 0; level <= 2; ++level)
            for (const bool cut : {false, true}) {
                const Input before = round(method);
                const Point middle{40, -2};
                const Input after = edited(before, {cut, {disc(middle.x, middle.y, 9)}, level});
                const RowField<float>&f = before.fitted->field, &g = after.fitted->field;
                ASSERT_EQ(f.frame, g.frame);
                const Point at = f.frame.toLattice(middle);
                const double reach = 9 / f.frame.spacing.x + 8 + 4 * std::ldexp(1.0, level);
                int same = 0, changed = 0;
                const Bounds box = f.bounds();
                for (std::int32_t y = box.first[1]; y <= box.last[1]; ++y)
                    for (std::int32_t x = box.first[0]; x <= box.last[0]; ++x) {
                        const bool equal = f.isKnown(x, y) == g.isKnown(x, y) && f.at(x, y) == g.at(x, y);
                        changed += !equal;
                        if (std::hypot(x - at.x, y - at.y) < reach) continue;
                        ASSERT_TRUE(equal) << x << " " << y << " level " << level;
                        same += f.isKnown(x, y);
                    }
                EXPECT_GT(same, 1000);
                EXPECT_GT(changed, 50);
            }
}

TEST(PlaneEdit, HasTheToolsSignAtEveryPixel) {
    const Input before = round();
    for (const bool cut : {false, true}) {
        const Polygon tool = rectangle(20, -30, 75, 15);
        const RowField<float>&f = before.fitted->field, g = edited(before, {cut, {tool}, 0}).fitted->field;
        const Region inTool = rasterise({tool}, f.frame);
        const Bounds box = g.bounds();
        int inside = 0;
        for (std::int32_t y = box.first[1]; y <= box.last[1]; ++y)
            for (std::int32_t x = box.first[0]; x <= box.last[0]; ++x) {
                const bool was = sample(f, {double(x), double(y)}).value < 0, t = inTool.contains(x, y);
                ASSERT_EQ(sample(g, {double(x), double(y)}).value < 0, cut ? was && !t : was || t)
                    << x << " " << y;
                inside += was && t;
            }
        EXPECT_GT(inside, 100);
    }
}

TEST(PlaneEdit, OfWhatWasAddedApartIsUndoneByItsCut) {
    const Input before = round();
    const Polygon tool = disc(75, 20, 8);
    const Input after = edited(edited(before, {false, {tool}, 1}), {true, {disc(75, 20, 9)}, 1});
    EXPECT_EQ(pyramidBytes(fitted(after)).size() > 0, true);
    const Curves a = extractCurves(before.fitted->field), b = extractCurves(after.fitted->field);
    ASSERT_EQ(a.rings.size(), b.rings.size());
    for (std::size_t r = 0; r < a.rings.size(); ++r) EXPECT_EQ(a.world(r), b.world(r));
}

// Below and left of the first control point: the lattice moves, the world and the coarser lattices do not.
TEST(PlaneEdit, BeyondTheLatticeKeepsTheWorldAndTheCoarserLattices) {
    const Input before = round();
    const Input after = edited(before, {false, {rectangle(-80, -90, -60, -70)}, 1});
    expectSound(after, "beyond");
    EXPECT_NEAR((areaOf(after) - areaOf(before)) / 400, 1, 0.02);
    EXPECT_LE(after.extent.low.x, -80);
    EXPECT_LE(after.extent.low.y, -90);
    const auto ofDisc = [](const Input& input, int level) {
        std::optional<Ring> found;
        traceSteps(input.fitted->field, 2 * level, Hold::none,
                   [&](const StepFacts& facts, const RowField<float>&, const Curves& curves, const Curves&) {
                       if (facts.step != 2 * level) return;
                       for (std::size_t r = 0; r < curves.rings.size(); ++r) {
                           const Ring ring = curves.world(r);
                           if (std::hypot(ring[0].x - 7.3, ring[0].y + 2.1) < 60) found = ring;
                       }
                   });
        return *found;
    };
    for (int level = 0; level <= 3; ++level) {
        Ring a = ofDisc(before, level), b = ofDisc(after, level);
        ASSERT_EQ(a.size(), b.size()) << level;
        for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(length(a[i] - b[i]), 0, 1e-9) << level;
    }
}

TEST(PlaneEdit, RefusesWhatChangesNothingOrLeavesNothing) {
    const Input input = round();
    const auto complaint = [&](const PolygonEdit& edit) -> std::string {
        try {
            edited(input, edit, "t.geojson");
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_THAT(complaint({true, {rectangle(-500, -500, 500, 500)}, 0}),
                HasSubstr("t.geojson: takes away all"));
    EXPECT_THAT(complaint({true, {rectangle(80, 80, 90, 90)}, 0}), HasSubstr("cuts nothing away"));
    EXPECT_THAT(complaint({false, {rectangle(5, 0, 9, 4)}, 0}), HasSubstr("adds nothing"));
    EXPECT_THAT(complaint({false, {rectangle(-10, -20, 25, 15)}, 1}), HasSubstr("adds nothing"));
    EXPECT_THAT(complaint({false, {rectangle(0, 0, 1e8, 9)}, 0}), HasSubstr("pixels beyond the shape"));
    EXPECT_THAT(complaint({false, {rectangle(70, 70, 71, 71)}, 5}),
                HasSubstr("no pixel's middle of level 5"));
}

// The shape once more, so many pixels away.
Input twice(const Input& input, std::int32_t dx, std::int32_t dy) {
    Fitted fitted = *input.fitted;
    const RowField<float> once = fitted.field;
    for (const auto& [y, row] : once.rows) {
        Row<float> copy = row;
        for (KnownRun& run : copy.runs) run = {run.first + dx, run.last + dx, run.insideAfter};
        Row<float>& to = fitted.field.rows[y + dy];
        to.runs.insert(to.runs.end(), copy.runs.begin(), copy.runs.end());
        to.values.insert(to.values.end(), copy.values.begin(), copy.values.end());
    }
    Input both = input;
    both.fitted = std::make_shared<const Fitted>(std::move(fitted));
    return both;
}

std::string refusalOf(const Input& input, const Polygon& tool) {
    try {
        edited(input, {false, {tool}, 0});
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

// Below -1 the lattice moves by more than its width, which must end where positions do.
TEST(PlaneEdit, RefusesALatticeThatWouldNotHoldTheShape) {
    const Input one = round();
    const Polygon beside = rectangle(-80, -10, -60, 10);
    const Point corner = one.fitted->field.frame.toLattice({-80, 0});
    ASSERT_LT(corner.x, -8);
    EXPECT_EQ(refusalOf(twice(one, 1 << 28, 0), beside), "");
    for (const std::int32_t far : {1 << 29, (1 << 30) - 1000})
        EXPECT_THAT(refusalOf(twice(one, far, 0), beside), HasSubstr("last one of the lattice")) << far;
}

TEST(PlaneEdit, RefusesMoreRowsThanFitIntoMemory) {
    EXPECT_THAT(refusalOf(twice(round(), 0, 1 << 29), rectangle(60, 5, 84.5, 31.25)),
                HasSubstr("rows of pixels, and 33554432 are taken at most"));
}

}  // namespace
}  // namespace isowave::curves2d
