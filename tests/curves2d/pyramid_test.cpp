// The promises of row_field.h, direction.h, pyramid.h and fit.h.
#include "curves2d/pyramid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "curves2d/fit.h"
#include "curves2d/shapes.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

using Json = nlohmann::json;
using Points = std::map<std::pair<int, int>, double>;

template <class Real>
Points pointsOf(const RowField<Real>& field) {
    Points points;
    for (const auto& [number, row] : field.rows) {
        std::size_t v = 0;
        for (const KnownRun& run : row.runs)
            for (std::int32_t p = run.first; p <= run.last; ++p)
                points[field.axis == 0 ? std::pair(p, number) : std::pair(number, p)] = row.values[v++];
        EXPECT_EQ(v, row.values.size());
    }
    return points;
}

// Infinite where the known sets differ.
template <class Real>
double difference(const RowField<Real>& a, const RowField<Real>& b) {
    const Points pa = pointsOf(a), pb = pointsOf(b);
    if (pa.size() != pb.size()) return INFINITY;
    double largest = 0;
    for (auto i = pa.begin(), j = pb.begin(); i != pa.end(); ++i, ++j) {
        if (i->first != j->first) return INFINITY;
        largest = std::max(largest, std::abs(i->second - j->second));
    }
    return largest;
}

template <class Real>
bool sameRows(const RowField<Real>& a, const RowField<Real>& b) {
    if (a.axis != b.axis || a.frame != b.frame || a.rowNumbers() != b.rowNumbers()) return false;
    for (const auto& [number, row] : a.rows)
        if (!(row == *b.find(number))) return false;
    return true;
}

// ---- row field ----

TEST(RowField, TransposedTwiceIsTheSameToTheBit) {
    for (const auto& [name, shape] : shapes::all()) {
        RowField<float> field = fitBinary<float>(shape);
        for (int step = 0; step < 6; ++step) {
            const RowField<float> other = transposed(field);
            EXPECT_EQ(other.axis, 1 - field.axis);
            EXPECT_EQ(pointsOf(field), pointsOf(other)) << name;
            EXPECT_TRUE(sameRows(field, transposed(other))) << name << " step " << step;
            field = transposed(analyseDirection(field).coarse);
        }
    }
}

TEST(RowField, EveryUnknownPointHasOneSignHoweverTheRowsRun) {
    for (const auto& [name, shape] : shapes::all()) {
        RowField<float> field = fitBinary<float>(shape);
        for (int step = 0; step < 4; ++step) {
            const RowField<float> other = transposed(field);
            const Bounds box = field.bounds();
            for (std::int32_t y = box.first[1] - 2; y <= box.last[1] + 2; ++y)
                for (std::int32_t x = box.first[0] - 2; x <= box.last[0] + 2; ++x)
                    ASSERT_EQ(field.at(x, y), other.at(x, y))
                        << name << " step " << step << " " << x << " " << y;
            field = transposed(analyseDirection(field).coarse);
        }
    }
}

TEST(RowField, SignsOfUnknownPointsAreTheInputs) {
    const Shape shape = shapes::target(5);
    const RowField<double> field = fitBinary<double>(shape);
    const Point shift = shape.frame.toWorld({0, 0}) - field.frame.origin;
    int inside = 0;
    for (std::int32_t y = -3; y < 90; ++y)
        for (std::int32_t x = -3; x < 90; ++x) {
            const auto fx = x + static_cast<std::int32_t>(shift.x),
                       fy = y + static_cast<std::int32_t>(shift.y);
            if (field.isKnown(fx, fy)) continue;
            EXPECT_EQ(field.at(fx, fy), shape.inside.contains(x, y) ? -1 : 1);
            inside += shape.inside.contains(x, y);
        }
    EXPECT_GT(inside, 0);  // both signs were looked at
    const RowField<double> slab = fitBinary<double>(shapes::bitmap(30, 30, [](int, int) { return true; }));
    EXPECT_EQ(slab.at(17, 17), -1);
    EXPECT_FALSE(slab.isKnown(17, 17));
}

TEST(RowField, SampleAgreesWithTheLatticeFilterAndItsGradientWithDifferences) {
    const RowField<double> field = fitBinary<double>(shapes::blobs(80, 30, 3));
    for (const RowField<double>& f : {field, transposed(field)})
        for (int i = 0; i < 200; ++i) {
            const Point p{5 + 0.37 * i, 70 - 0.31 * i};
            const Sample s = sample(f, p);
            const double h = 1e-5;
            EXPECT_NEAR(s.gradient.x,
                        (sample(f, p + Point{h, 0}).value - sample(f, p - Point{h, 0}).value) / (2 * h),
                        1e-8);
            EXPECT_NEAR(s.gradient.y,
                        (sample(f, p + Point{0, h}).value - sample(f, p - Point{0, h}).value) / (2 * h),
                        1e-8);
            double value = 0;
            const int x = static_cast<int>(p.x), y = static_cast<int>(p.y);
            for (int b = -1; b <= 1; ++b)
                for (int a = -1; a <= 1; ++a) value += (a ? 1 : 4) * (b ? 1 : 4) / 36.0 * f.at(x + a, y + b);
            EXPECT_NEAR(sample(f, {double(x), double(y)}).value, value, 1e-15);
        }
}

TEST(RowField, DefinedNodesAreThoseWithSixteenKnownControlPoints) {
    for (const auto& [name, shape] : shapes::all()) {
        const RowField<float> field = fitBinary<float>(shape);
        const Bounds box = field.bounds();
        std::int64_t count = 0;
        for (std::int32_t y = box.first[1]; y <= box.last[1]; ++y)
            for (std::int32_t x = box.first[0]; x <= box.last[0]; ++x) {
                bool all = true;
                for (int k = 0; k < 16 && all; ++k) all = field.isKnown(x + k % 4, y + k / 4);
                count += all;
            }
        EXPECT_EQ(definedNodeCount(field), count) << name;
        EXPECT_EQ(definedNodeCount(transposed(field)), count) << name;
    }
}

// ---- fit ----

TEST(Fit, SignsAgreeWithTheBitmapAtEveryLatticePoint) {
    for (const auto& [name, shape] : shapes::all()) {
        FitReport report;
        const RowField<float> field = fitBinary<float>(shape, {}, &report);
        EXPECT_EQ(report.disagreeing, 0) << name;
        EXPECT_EQ(report.latticePoints, field.controlPointCount()) << name;
        const Point shift = shape.frame.origin - field.frame.origin;
        for (std::int32_t y = -2; y < 160; ++y)
            for (std::int32_t x = -2; x < 160; ++x) {
                const double F = sample(field, Point{double(x), double(y)} + shift).value;
                ASSERT_EQ(F < 0, shape.inside.contains(x, y)) << name << " " << x << " " << y;
            }
    }
}

TEST(Fit, NothingLiesBelowMinusOne) {
    for (const auto& [name, shape] : shapes::all()) {
        const Bounds box = fitBinary<float>(shape).bounds();
        EXPECT_GE(box.first[0], -1) << name;
        EXPECT_GE(box.first[1], -1) << name;
    }
}

TEST(Fit, AnEmptyShapeGivesAnEmptyFieldAndNoSteps) {
    const RowField<float> field = fitBinary<float>(Shape{});
    EXPECT_EQ(field.controlPointCount(), 0);
    EXPECT_EQ(analyse(field).stepCount(), 0);
}

// ---- pyramid ----

template <class Real>
double worstRoundTrip() {
    double worst = 0;
    for (const auto& [name, shape] : shapes::all()) {
        const RowField<Real> field = fitBinary<Real>(shape);
        std::vector<RowField<Real>> onTheWay;
        const Pyramid<Real> pyramid =
            analyse<Real>(field, 1000, {}, [&](int, const RowField<Real>& f) { onTheWay.push_back(f); });
        EXPECT_EQ(pyramid.coarsest.controlPointCount(), 16) << name;
        EXPECT_EQ(static_cast<int>(onTheWay.size()), pyramid.stepCount() + 1);
        for (int step = pyramid.stepCount(); step >= 0; --step) {
            const RowField<Real> back = pyramid.field(step);
            EXPECT_EQ(back.frame, onTheWay[step].frame);
            worst = std::max(worst, difference(back, onTheWay[step]));
        }
    }
    return worst;
}

TEST(PlanePyramid, RoundTripInFloatIsWithinTenToTheMinusFive) { EXPECT_LT(worstRoundTrip<float>(), 1e-5); }
TEST(PlanePyramid, RoundTripInDoubleIsWithinTenToTheMinusTwelve) {
    EXPECT_LT(worstRoundTrip<double>(), 1e-12);
}

TEST(PlanePyramid, OneDetailChangedIsSeen) {
    const RowField<double> field = fitBinary<double>(shapes::blobs(100, 40, 9));
    Pyramid<double> pyramid = analyse(field);
    pyramid.steps[2].rows[3].details[1] += 1e-3;
    EXPECT_GT(difference(pyramid.field(0), field), 1e-5);
}

TEST(PlanePyramid, SameToTheBitForAnyNumberOfThreads) {
    const RowField<float> field = fitBinary<float>(shapes::blobs(300, 80, 5));
    std::vector<Pyramid<float>> made;
    for (const std::size_t threads : {1, 2, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        made.push_back(analyse(field));
    }
    for (std::size_t i = 1; i < made.size(); ++i) {
        EXPECT_TRUE(sameRows(made[0].coarsest, made[i].coarsest));
        for (std::size_t s = 0; s < made[0].steps.size(); ++s)
            EXPECT_EQ(made[0].steps[s].rows, made[i].steps[s].rows);
        EXPECT_TRUE(sameRows(made[0].field(0), made[i].field(0)));
    }
}

TEST(PlanePyramid, RefusesPartsThatDoNotBelongTogether) {
    Pyramid<float> a = analyse(fitBinary<float>(shapes::disc(20))),
                   b = analyse(fitBinary<float>(shapes::disc(9)));
    std::swap(a.steps[1], b.steps[1]);
    EXPECT_THROW(a.field(0), InputError);
    Pyramid<float> c = analyse(fitBinary<float>(shapes::disc(20)));
    c.steps[0].rows[3].details.pop_back();
    EXPECT_THROW(c.field(0), InputError);
}

TEST(PlanePyramid, StepsAreNamedByLevelAndAHalfStepByTheLevelBefore) {
    EXPECT_EQ(stepName(0), "L0");
    EXPECT_EQ(stepName(1), "L0a");
    EXPECT_EQ(stepName(2), "L1");
    EXPECT_EQ(stepName(19), "L9a");
}

// ---- the oracle ----

struct Golden {
    std::vector<RowField<double>> fields;
    std::vector<Points> details;
};

RowField<double> fieldOf(const Json& json) {
    // Rows run along y here, to begin with: the oracle sorts points by x, then y.
    RowField<double> field;
    field.axis = 1;
    for (std::size_t i = 0; i < json["at"].size(); ++i) {
        const std::int32_t x = json["at"][i][0], y = json["at"][i][1];
        Row<double>& row = field.rows[x];
        if (!row.runs.empty() && row.runs.back().last == y - 1) {
            row.runs.back().last = y;
        } else {
            // A gap has the sign of the known point before it: what lies there is not stabbed.
            if (!row.runs.empty()) row.runs.back().insideAfter = json["inside"][i - 1] == 1;
            row.runs.push_back({y, y, false});
        }
        row.values.push_back(json["value"][i]);
    }
    return field;
}

class Oracle : public testing::TestWithParam<const char*> {};

TEST_P(Oracle, ControlPointsDetailsAndShapesAgree) {
    std::ifstream stream(std::string(ISOWAVE_TEST_DATA "/oracle/") + GetParam() + ".json");
    const Json json = Json::parse(stream);
    std::vector<RowField<double>> fields;
    const Pyramid<double> pyramid =
        analyse<double>(fieldOf(json["fields"][0]), static_cast<int>(json["details"].size()), {},
                        [&](int, const RowField<double>& f) { fields.push_back(f); });
    ASSERT_EQ(fields.size(), json["fields"].size());
    for (std::size_t s = 0; s < fields.size(); ++s)
        EXPECT_LT(difference(fields[s], fieldOf(json["fields"][s])), 1e-7)
            << "step " << s;  // seen 1e-9: its digits
    for (std::size_t s = 0; s < pyramid.steps.size(); ++s) {
        const Json& expected = json["details"][s];
        ASSERT_EQ(expected["axis"], pyramid.steps[s].axis);
        ASSERT_EQ(static_cast<std::int64_t>(expected["at"].size()), pyramid.steps[s].detailCount());
        std::map<std::int32_t, std::vector<double>> byRow;  // ascending along a row, as the oracle sorts them
        for (std::size_t i = 0; i < expected["at"].size(); ++i)
            byRow[expected["at"][i][1 - pyramid.steps[s].axis]].push_back(expected["value"][i]);
        for (const StepRow<double>& row : pyramid.steps[s].rows) {
            ASSERT_EQ(row.details.size(), byRow[row.row].size());
            for (std::size_t i = 0; i < row.details.size(); ++i)
                EXPECT_NEAR(row.details[i], byRow[row.row][i], 1e-7);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Golden, Oracle, testing::Values("plane", "plane_noise"));

}  // namespace
}  // namespace isowave::curves2d
