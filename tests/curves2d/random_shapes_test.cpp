// The promises of direction.h on thousands of small random bitmaps, in any order of the two axes: the planar twin of
// tests/wavelets/random_shapes_test.cpp.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "curves2d/direction.h"
#include "curves2d/fit.h"
#include "curves2d/shapes.h"

namespace isowave::curves2d {
namespace {

// The same numbers on every machine (the standard's distributions are not).
class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    int between(int low, int high) {
        return low + static_cast<int>(engine_() % static_cast<unsigned>(high - low + 1));
    }

  private:
    std::mt19937 engine_;
};

// What the fit makes of noise of any density or of rectangles put together and taken away; every second time with control
// points that no fit would give, any in [-K, K).
template <class Real>
RowField<Real> randomField(Random& random) {
    const int width = random.between(1, 40), height = random.between(1, 40);
    std::vector<char> inside(static_cast<std::size_t>(width * height));
    const int density = random.between(2, 20);
    if (random.between(0, 1))
        for (char& point : inside) point = random.between(1, density) == 1;
    for (int k = random.between(1, 6); k-- > 0;) {
        const int left = random.between(0, width - 1), right = random.between(left, width - 1);
        const int low = random.between(0, height - 1), high = random.between(low, height - 1);
        const char value = random.between(0, 2) != 0;
        for (int y = low; y <= high; ++y)
            for (int x = left; x <= right; ++x) inside[static_cast<std::size_t>(y * width + x)] = value;
    }
    inside[static_cast<std::size_t>(random.between(0, width * height - 1))] = 1;
    RowField<Real> field = fitBinary<Real>(
        shapes::bitmap(width, height, [&](int x, int y) { return inside[y * width + x] != 0; }),
        {.passes = random.between(0, 3)});
    if (random.between(0, 1))
        for (const std::int32_t number : field.rowNumbers())
            for (Real& value : field.rows[number].values)
                value = static_cast<Real>(random.between(-1000, 999)) / 1000;
    return field;
}

// Calls check(field, axes, random) for `count` bitmaps.
template <class Real, class Check>
void forRandomFields(unsigned count, const Check& check) {
    for (unsigned seed = 0; seed < count; ++seed) {
        Random random(seed);
        const RowField<Real> field = randomField<Real>(random);
        std::vector<int> axes(static_cast<std::size_t>(random.between(2, 6)));
        std::string order;
        for (int& axis : axes) order += "xy"[axis = random.between(0, 1)];
        SCOPED_TRACE("seed " + std::to_string(seed) + ", axes " + order);
        check(field, axes, random);
        if (testing::Test::HasFailure()) return;  // one is enough to look at
    }
}

template <class Real>
RowField<Real> along(int axis, const RowField<Real>& field) {
    return field.axis == axis ? field : transposed(field);
}

template <class Real>
struct Taken {
    std::vector<Step<Real>> steps;
    RowField<Real> coarse;
};

template <class Real>
Taken<Real> takeApart(const RowField<Real>& field, const std::vector<int>& axes) {
    Taken<Real> taken{{}, field};
    for (const int axis : axes) {
        DirectionResult<Real> result = analyseDirection(along(axis, taken.coarse));
        taken.steps.push_back(std::move(result.step));
        taken.coarse = std::move(result.coarse);
    }
    return taken;
}

template <class Real>
RowField<Real> putTogether(const Taken<Real>& taken) {
    RowField<Real> field = taken.coarse;
    for (auto step = taken.steps.rbegin(); step != taken.steps.rend(); ++step)
        field = synthesiseDirection(along(step->axis, field), *step);
    return field;
}

// Infinite where the known sets, or the signs of what is unknown, differ.
template <class Real>
double difference(const RowField<Real>& a, const RowField<Real>& other) {
    const RowField<Real> b = along(a.axis, other);
    if (a.rowNumbers() != b.rowNumbers()) return INFINITY;
    double largest = 0;
    for (const auto& [number, row] : a.rows) {
        const Row<Real>& twin = *b.find(number);
        if (row.runs != twin.runs) return INFINITY;
        for (std::size_t i = 0; i < row.values.size(); ++i)
            largest = std::max(largest, std::abs(double(row.values[i]) - double(twin.values[i])));
    }
    return largest;
}

template <class Real>
double worstRoundTrip(unsigned count) {
    double worst = 0;
    forRandomFields<Real>(count, [&](const RowField<Real>& field, const std::vector<int>& axes, Random&) {
        worst = std::max(worst, difference(field, putTogether(takeApart(field, axes))));
    });
    return worst;
}

TEST(RandomBitmaps, ComeBackWhateverTheOrderOfTheAxes) {
    EXPECT_LT(worstRoundTrip<float>(2000), 1e-5);
    EXPECT_LT(worstRoundTrip<double>(2000), 1e-12);
}

TEST(RandomBitmaps, HaveRunsOfFourOrMoreAlongBothAxesAfterEveryStep) {
    forRandomFields<float>(2000, [](RowField<float> field, const std::vector<int>& axes, Random&) {
        for (const int axis : axes) {
            field = analyseDirection(along(axis, field)).coarse;
            for (const int a : {0, 1})
                for (const auto& [number, row] : along(a, field).rows)
                    for (const KnownRun& run : row.runs) EXPECT_GE(run.last - run.first + 1, 4) << number;
        }
    });
}

TEST(RandomBitmaps, GiveTheSameBitsForOneTwoAndFourThreads) {
    forRandomFields<float>(1000, [](const RowField<float>& field, const std::vector<int>& axes, Random&) {
        std::vector<Taken<float>> made;
        for (const std::size_t threads : {1, 2, 4}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            made.push_back(takeApart(field, axes));
            EXPECT_EQ(difference(made[0].coarse, made.back().coarse), 0);
            EXPECT_EQ(difference(putTogether(made[0]), putTogether(made.back())), 0);
            for (std::size_t s = 0; s < axes.size(); ++s)
                EXPECT_EQ(made[0].steps[s].rows, made.back().steps[s].rows);
        }
    });
}

// by: x and y.
RowField<float> moved(const RowField<float>& field, const std::array<int, 2>& by) {
    RowField<float> result = field;
    result.rows.clear();
    for (const auto& [number, row] : field.rows) {
        Row<float>& to = result.rows[number + by[static_cast<std::size_t>(1 - field.axis)]] = row;
        for (KnownRun& run : to.runs) {
            run.first += by[static_cast<std::size_t>(field.axis)];
            run.last += by[static_cast<std::size_t>(field.axis)];
        }
    }
    return result;
}

TEST(RandomBitmaps, MovedByEvenOffsetsGiveTheSameBitsMoved) {
    int differ = 0;
    forRandomFields<float>(
        2000, [&](const RowField<float>& field, const std::vector<int>& axes, Random& random) {
            // A multiple of 2 for every time that an axis is halved.
            std::array<int, 2> by = {random.between(-9, 9), random.between(-9, 9)}, odd = by;
            for (const int axis : axes) by[axis] *= 2;
            const Taken<float> a = takeApart(field, axes), b = takeApart(moved(field, by), axes);
            for (std::size_t s = 0; s < axes.size(); ++s) {
                by[axes[s]] /= 2;
                ASSERT_EQ(a.steps[s].rows.size(), b.steps[s].rows.size());
                for (std::size_t i = 0; i < a.steps[s].rows.size(); ++i) {
                    EXPECT_EQ(a.steps[s].rows[i].row + by[1 - axes[s]], b.steps[s].rows[i].row);
                    EXPECT_EQ(a.steps[s].rows[i].details, b.steps[s].rows[i].details);
                }
            }
            EXPECT_EQ(difference(moved(a.coarse, by), b.coarse), 0);
            // So that this can fail: an odd offset gives other details.
            odd[axes[0]] |= 1;
            const Taken<float> c = takeApart(moved(field, odd), {axes[0]});
            for (std::size_t i = 0; i < c.steps[0].rows.size(); ++i)
                if (c.steps[0].rows[i].details != a.steps[0].rows[i].details) {
                    ++differ;
                    break;
                }
        });
    EXPECT_EQ(differ, 2000);
}

}  // namespace
}  // namespace isowave::curves2d
