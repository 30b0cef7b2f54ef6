// The promises of volume/row_ascent.h.
#include "volume/row_ascent.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>

#include "volume/cubic_weights.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

// Random values on the box [0, size)^3, all of it known; +1 beyond.
BSplineField randomField(int size, unsigned seed) {
    BSplineField field;
    field.controlPoints = openvdb::FloatGrid::create(1.0f);
    field.shape = Shape::create(false);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1, 1);
    auto accessor = field.controlPoints->getAccessor();
    for (int x = 0; x < size; ++x)
        for (int y = 0; y < size; ++y)
            for (int z = 0; z < size; ++z) accessor.setValue(Coord(x, y, z), value(random));
    return field;
}

// Random rows whose 64 control points lie in [margin, size - margin).
std::vector<FieldRow> randomRows(int count, int size, unsigned seed, double margin = 0) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(1 + margin, size - 2 - margin - 1e-6), unit(0, 1);
    std::vector<FieldRow> rows;
    for (int i = 0; i < count; ++i) {
        FieldRow row{{place(random), place(random), place(random)}};
        row.sign = unit(random) < 0.5 ? -1.0f : 1.0f;
        row.bound = static_cast<float>(0.1 * unit(random));
        row.equal = unit(random) < 0.3;
        row.rho = unit(random) < 0.5 ? 0.0f : 0.05f;
        rows.push_back(row);
    }
    return rows;
}

std::vector<float> valuesOf(const BSplineField& field) {
    std::vector<float> values;
    for (auto voxel = field.controlPoints->cbeginValueOn(); voxel; ++voxel) values.push_back(*voxel);
    return values;
}

BSplineField copyOf(const BSplineField& field) {
    return {field.controlPoints->deepCopy(), field.shape->deepCopy(), field.K};
}

double squaredChange(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
    return sum;
}

double violationOf(const BSplineField& field, const FieldRow& row) {
    return row.sign * evaluate(field, row.at) + row.bound;
}

// |c - c0|^2/2 + soft violations: what the ascent makes least.
double costOf(const BSplineField& field, const std::vector<float>& before,
              const std::vector<FieldRow>& rows) {
    double cost = squaredChange(valuesOf(field), before) / 2;
    for (const FieldRow& row : rows) {
        if (row.rho == 0) continue;
        const double r = violationOf(field, row), v = row.equal ? r : std::max(0.0, r);
        cost += v * v / (2 * row.rho);
    }
    return cost;
}

// ---- exact: the optimum of a few rows, by trying every set of active ones

// Weights of a row on a dense [0, size)^3.
std::vector<double> denseRow(const Vec3d& at, int size) {
    std::vector<double> w(static_cast<std::size_t>(size * size * size));
    std::array<std::array<double, 4>, 3> each;
    std::array<int, 3> first;
    for (int a = 0; a < 3; ++a) {
        first[a] = int(std::floor(at[a])) - 1;
        each[a] = cubicWeights(at[a] - std::floor(at[a]));
    }
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k)
                w[static_cast<std::size_t>(((first[0] + i) * size + first[1] + j) * size + first[2] + k)] =
                    each[0][i] * each[1][j] * each[2][k];
    return w;
}

// Solves a small symmetric system; nothing where it is singular.
std::optional<std::vector<double>> solved(std::vector<std::vector<double>> a, std::vector<double> b) {
    const std::size_t n = b.size();
    for (std::size_t i = 0; i < n; ++i) {
        std::size_t pivot = i;
        for (std::size_t r = i; r < n; ++r)
            if (std::abs(a[r][i]) > std::abs(a[pivot][i])) pivot = r;
        if (std::abs(a[pivot][i]) < 1e-14) return {};
        std::swap(a[i], a[pivot]);
        std::swap(b[i], b[pivot]);
        for (std::size_t r = i + 1; r < n; ++r) {
            const double factor = a[r][i] / a[i][i];
            for (std::size_t c = i; c < n; ++c) a[r][c] -= factor * a[i][c];
            b[r] -= factor * b[i];
        }
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t c = i + 1; c < n; ++c) b[i] -= a[i][c] * b[c];
        b[i] /= a[i][i];
    }
    return b;
}

// The multipliers of the optimum (KKT): those of the active rows solve (W W^T + rho) lambda = r; the right
// set has lambda >= 0 and no other row violated. Rows: sign F + bound <= 0, residual r at c0.
std::vector<double> exactMultipliers(const std::vector<FieldRow>& rows, const std::vector<double>& residual,
                                     const std::vector<std::vector<double>>& gram) {
    const std::size_t n = rows.size();
    for (std::size_t set = 0; set < (std::size_t(1) << n); ++set) {
        std::vector<std::size_t> in;
        bool allowed = true;
        for (std::size_t i = 0; i < n; ++i) {
            if (set >> i & 1) in.push_back(i);
            allowed = allowed && (set >> i & 1 || !rows[i].equal);
        }
        if (!allowed) continue;
        std::vector<std::vector<double>> a;
        std::vector<double> b;
        for (const std::size_t i : in) {
            a.emplace_back();
            for (const std::size_t j : in)
                a.back().push_back(gram[i][j] + (i == j ? double(rows[i].rho) : 0.0));
            b.push_back(residual[i]);
        }
        const auto lambda = solved(a, b);
        if (!lambda) continue;
        std::vector<double> all(n);
        for (std::size_t k = 0; k < in.size(); ++k) all[in[k]] = (*lambda)[k];
        bool right = true;
        for (std::size_t i = 0; i < n; ++i) {
            double r = residual[i];
            for (std::size_t j = 0; j < n; ++j) r -= gram[i][j] * all[j];
            right = right && (rows[i].equal || (set >> i & 1 ? all[i] >= 0 : r <= 1e-12));
        }
        if (right) return all;
    }
    return {};
}

TEST(RowAscent, FindsTheExactOptimumOfSmallPrograms) {
    constexpr int kBox = 9;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const BSplineField before = randomField(kBox, seed);
        std::vector<FieldRow> rows = randomRows(8, kBox, seed + 100, 1);
        std::vector<std::vector<double>> w, gram;
        std::vector<double> residual;
        for (const FieldRow& row : rows) {
            w.push_back(denseRow(row.at, kBox));
            for (double& value : w.back()) value *= row.sign;
            residual.push_back(violationOf(before, row));
        }
        for (const auto& a : w) {
            gram.emplace_back();
            for (const auto& b : w)
                gram.back().push_back(std::inner_product(a.begin(), a.end(), b.begin(), 0.0));
        }
        const std::vector<double> lambda = exactMultipliers(rows, residual, gram);
        ASSERT_EQ(lambda.size(), rows.size()) << seed;

        BSplineField field = copyOf(before);
        const AscentReport report = ascend(field, rows, {.tolerance = 1e-7, .rounds = 5000});
        EXPECT_TRUE(report.settled) << seed;
        EXPECT_EQ(report.unmet, 0);
        double most = 0;
        const auto accessor = field.controlPoints->getConstUnsafeAccessor(),
                   old = before.controlPoints->getConstUnsafeAccessor();
        for (int i = 0; i < kBox * kBox * kBox; ++i) {
            const Coord c(i / (kBox * kBox), i / kBox % kBox, i % kBox);
            double expected = old.getValue(c);
            for (std::size_t r = 0; r < rows.size(); ++r) expected -= lambda[r] * w[r][std::size_t(i)];
            most = std::max(most, std::abs(expected - accessor.getValue(c)));
        }
        EXPECT_LT(most, 1e-6) << seed;  // seen 2.8e-7
    }
}

TEST(RowAscent, OneRowIsAProjection) {
    BSplineField field = randomField(8, 3);
    const BSplineField before = copyOf(field);
    const FieldRow row{{3.3, 3.6, 2.9}, 1, 2.0f};  // F <= -2
    const AscentReport report = ascend(field, {row});
    EXPECT_NEAR(evaluate(field, row.at), -2, 1e-6);
    EXPECT_EQ(report.changed, 64);
    const auto w = denseRow(row.at, 8);
    const double squares = std::inner_product(w.begin(), w.end(), w.begin(), 0.0);
    EXPECT_NEAR(squaredChange(valuesOf(field), valuesOf(before)),
                std::pow(violationOf(before, row), 2) / squares, 1e-4);
}

// v^2/(2 rho) + (v0 - v)^2/(2 sum w^2) is least for v = v0 rho/(sum w^2 + rho); one visit is enough, however soft the row.
TEST(RowAscent, OneSoftRowIsMetAsFarAsItIsWorthInOneVisit) {
    for (const float rho : {0.01f, 1.0f, 100.0f}) {
        BSplineField field = randomField(8, 3);
        const FieldRow row{{3.3, 3.6, 2.9}, 1, 2.0f, rho};
        const auto w = denseRow(row.at, 8);
        const double squares = std::inner_product(w.begin(), w.end(), w.begin(), 0.0),
                     before = violationOf(field, row);
        const AscentReport report = ascend(field, {row}, {.tolerance = 1e-7});
        EXPECT_NEAR(violationOf(field, row), before * rho / (squares + rho), 1e-5) << rho;
        EXPECT_TRUE(report.settled) << rho;
        EXPECT_LE(report.rounds, 2) << rho;
    }
}

TEST(RowAscent, MeetsHardRowsAndNoSmallChangeIsCheaper) {
    const BSplineField before = randomField(24, 5);
    std::vector<FieldRow> rows = randomRows(700, 24, 6);
    BSplineField field = copyOf(before);
    const AscentReport report = ascend(field, rows, {.tolerance = 1e-6, .rounds = 3000});
    EXPECT_TRUE(report.settled);
    EXPECT_EQ(report.unmet, 0);
    EXPECT_EQ(report.rows, 700);
    int broken = 0, brokenBefore = 0;
    for (const FieldRow& row : rows) {
        if (row.rho > 0) continue;
        const auto isBroken = [&row](const BSplineField& f) {
            const double r = violationOf(f, row);
            return (row.equal ? std::abs(r) : r) > 1e-4;
        };
        broken += isBroken(field);
        brokenBefore += isBroken(before);
    }
    EXPECT_EQ(broken, 0);
    EXPECT_GT(brokenBefore, 100);
    // Soft rows alone: no step from the optimum lowers the cost.
    std::erase_if(rows, [](const FieldRow& row) { return row.rho == 0; });
    field = copyOf(before);
    ascend(field, rows, {.tolerance = 1e-7, .rounds = 3000});
    const std::vector<float> old = valuesOf(before);
    const double least = costOf(field, old, rows);
    EXPECT_LT(least, costOf(before, old, rows));
    std::mt19937 random(7);
    std::normal_distribution<float> step(0, 1e-2f);
    for (int k = 0; k < 20; ++k) {
        BSplineField other = copyOf(field);
        for (auto voxel = other.controlPoints->beginValueOn(); voxel; ++voxel)
            voxel.setValue(*voxel + step(random));
        EXPECT_GT(costOf(other, old, rows), least);
    }
}

TEST(RowAscent, InnerSweepsLeadToTheSameOptimumInFewerRounds) {
    const BSplineField before = randomField(24, 8);
    const std::vector<FieldRow> rows = randomRows(700, 24, 9);
    BSplineField plain = copyOf(before), inner = copyOf(before);
    const auto a = ascend(plain, rows, {.tolerance = 1e-6, .rounds = 3000});
    const auto b = ascend(inner, rows, {.tolerance = 1e-6, .rounds = 3000, .innerSweeps = 12});
    EXPECT_LT(b.rounds, a.rounds);
    EXPECT_LT(std::sqrt(squaredChange(valuesOf(plain), valuesOf(inner))), 1e-2);
}

TEST(RowAscent, GivesTheSameBitsForAnyThreadsAndOrderOfRows) {
    const BSplineField before = randomField(40, 11);
    std::vector<FieldRow> rows = randomRows(3000, 40, 12);
    const AscentOptions options{.rounds = 12, .innerSweeps = 3};
    std::vector<std::vector<float>> results;
    for (const std::size_t threads : {1, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        BSplineField field = copyOf(before);
        ascend(field, rows, options);
        results.push_back(valuesOf(field));
    }
    std::shuffle(rows.begin(), rows.end(), std::mt19937(1));
    BSplineField field = copyOf(before);
    ascend(field, rows, options);
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], valuesOf(field));
    EXPECT_NE(results[0], valuesOf(before));
}

TEST(RowAscent, LeavesEveryBitWhereNothingIsViolated) {
    const BSplineField before = randomField(16, 13);
    std::vector<FieldRow> rows = randomRows(300, 16, 14);
    for (FieldRow& row : rows) {
        row.equal = false;
        row.bound = -5;
    }
    BSplineField field = copyOf(before);
    const AscentReport report = ascend(field, rows);
    EXPECT_EQ(valuesOf(field), valuesOf(before));
    EXPECT_EQ(report.changed, 0);
    EXPECT_EQ(report.rounds, 1);
    EXPECT_EQ(ascend(field, {}).rounds, 0);
    rows[0].bound = 5;
    EXPECT_GT(ascend(field, rows).changed, 32);  // 64 weights, some below float's rounding
}

TEST(RowAscent, KeepsWhatIsNotKnownAndMeetsTheRowsByTheRest) {
    BSplineField field = randomField(16, 15);
    auto accessor = field.controlPoints->getAccessor();
    for (int x = 0; x < 16; ++x)
        for (int y = 0; y < 16; ++y)
            for (int z = 0; z < 16; ++z)
                if (x + y > 15) accessor.setValueOff(Coord(x, y, z), 1.0f);
    const std::vector<FieldRow> rows = {{{7.5, 7.5, 7.5}, 1, 0.3f},   // F <= -0.3, across the border
                                        {{-0.5, 6.0, 6.0}, 1, 0.1f},  // reaches into tiles and absent leaves
                                        {{40, 40, 40}, 1, 0.1f},      // reaches nothing that is known
                                        {{12.5, 12.5, 12.5}, 1, 0.1f}};
    const AscentReport report = ascend(field, rows);
    EXPECT_NEAR(evaluate(field, rows[0].at), -0.3, 0.003);
    EXPECT_NEAR(evaluate(field, rows[1].at), -0.1, 0.003);
    EXPECT_EQ(report.unmet, 2);
    EXPECT_EQ(field.controlPoints->activeVoxelCount(), 16u * (16 * 17 / 2));
    for (auto voxel = field.controlPoints->cbeginValueOff(); voxel; ++voxel) ASSERT_EQ(*voxel, 1.0f);
}

// The length of its step counts the weights of known control points alone.
TEST(RowAscent, ARowAcrossTheBorderIsMetInOneVisit) {
    BSplineField field = randomField(16, 15);
    auto accessor = field.controlPoints->getAccessor();
    for (int x = 8; x < 16; ++x)
        for (int y = 0; y < 16; ++y)
            for (int z = 0; z < 16; ++z) accessor.setValueOff(Coord(x, y, z), 1.0f);
    const FieldRow row{{7.5, 7.5, 7.5}, 1, 0.3f};  // half of its control points are known
    const AscentReport report = ascend(field, {row}, {.tolerance = 1e-6});
    EXPECT_NEAR(evaluate(field, row.at), -0.3, 1e-5);
    EXPECT_LE(report.rounds, 2);
}

TEST(RowAscent, PlacesFarFromEachOtherDoNotKnowOfEachOther) {
    const BSplineField before = randomField(40, 17);
    std::vector<FieldRow> low, high, both;
    for (const FieldRow& row : randomRows(4000, 40, 18)) {
        if (std::max({row.at[0], row.at[1], row.at[2]}) < 14) low.push_back(row);
        if (std::min({row.at[0], row.at[1], row.at[2]}) > 25) high.push_back(row);
    }
    both = low;
    both.insert(both.end(), high.begin(), high.end());
    BSplineField alone = copyOf(before), together = copyOf(before);
    ascend(alone, low, {.rounds = 200});
    ascend(together, both, {.rounds = 200});
    const auto a = alone.controlPoints->getConstUnsafeAccessor(),
               b = together.controlPoints->getConstUnsafeAccessor();
    for (int i = 0; i < 16 * 16 * 16; ++i) {
        const Coord c(i / 256, i / 16 % 16, i % 16);
        ASSERT_EQ(a.getValue(c), b.getValue(c)) << c;
    }
    EXPECT_GT(low.size(), 50u);
    EXPECT_GT(high.size(), 50u);
}

TEST(RowAscent, NamesRowsThatCannotBeMetTogether) {
    BSplineField field = randomField(8, 19);
    const AscentReport report =
        ascend(field, {{{3.5, 3.5, 3.5}, 1, 0.5f}, {{3.5, 3.5, 3.5}, -1, 0.5f}}, {.rounds = 30});
    EXPECT_EQ(report.rounds, 30);
    EXPECT_FALSE(report.settled);
    EXPECT_GE(report.unmet, 1);
    for (const float value : valuesOf(field)) EXPECT_TRUE(std::isfinite(value));
}

TEST(RowAscent, StopsWhereAskedTo) {
    BSplineField field = randomField(8, 20);
    Progress progress;
    progress.stopRequested = [] { return true; };
    EXPECT_THROW(ascend(field, randomRows(10, 8, 21), {}, progress), Cancelled);
}

}  // namespace
}  // namespace isowave
