// The promises of wavelets/interval/interval.h and interval/matrices.h, one test each.
#include "wavelets/interval/interval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "wavelets/interval/matrices.h"

namespace isowave::wavelets {
namespace {

struct Result {
    std::vector<double> coarse, detail;
};

Result analysed(const std::vector<double>& fine, double left, double right) {
    const std::size_t n = (fine.size() - 3) / 2;
    Result r{std::vector<double>(n + 3), std::vector<double>(n)};
    IntervalTransform().analyse(fine, left, right, r.coarse, r.detail);
    return r;
}

std::vector<double> synthesised(const Result& r, double left, double right) {
    std::vector<double> fine(2 * r.detail.size() + 3);
    IntervalTransform().synthesise(r.coarse, r.detail, left, right, fine);
    return fine;
}

std::vector<double> randomLine(int n, std::mt19937& rng) {
    std::uniform_real_distribution<double> value(-1, 1);
    std::vector<double> fine(2 * n + 3);
    for (double& x : fine) x = value(rng);
    return fine;
}

double largestDifference(const std::vector<double>& a, const std::vector<double>& b) {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
}

TEST(IntervalMatrices, InnerRowsOfTheGramMatrixAreTheKnownFractions) {
    const Matrix gram = gramMatrix(8);
    const int row[] = {1, 120, 1191, 2416, 1191, 120, 1};
    for (int s = -3; s <= 3; ++s) EXPECT_NEAR(double(gram(5, 5 + s)), row[s + 3] / 5040.0, 1e-16);
    // All B-splines add up to 1 on the domain: the entries add up to its length.
    EXPECT_NEAR(double(gram.sum()), 8.0, 1e-15);
}

TEST(IntervalMatrices, DetailsAreOrthogonalToTheCoarseSpace) {
    for (int n = 5; n <= 40; ++n) {
        const Matrix product = twoScaleMatrix(n).transpose() * gramMatrix(2 * n) * waveletMatrix(n);
        EXPECT_LT(double(product.cwiseAbs().maxCoeff()), 1e-15) << n;
    }
}

TEST(IntervalMatrices, InteriorWaveletIsChuiAndWangs) {
    const int integers[] = {1, -124, 1677, -7904, 18482, -24264};
    const Matrix q = waveletMatrix(9);
    // Found from orthogonality alone: the null space on 11 rows around the middle.
    Eigen::FullPivLU<Matrix> lu((twoScaleMatrix(9).transpose() * gramMatrix(18)).middleCols(5, 11));
    lu.setThreshold(1e-12L);
    const Matrix kernel = lu.kernel();
    ASSERT_EQ(kernel.cols(), 1);
    for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(double(q(5 + i, 4)), integers[i] / -24264.0, 1e-15);
        EXPECT_NEAR(double(kernel(i, 0) / kernel(5, 0)), integers[i] / -24264.0, 1e-12);
    }
}

TEST(IntervalMatrices, SynthesisIsWellConditionedForEveryLength) {
    for (int n = 5; n <= 60; ++n) {
        const Eigen::MatrixXd t = interleavedMatrix(n).cast<double>();
        const auto values = Eigen::JacobiSVD<Eigen::MatrixXd>(t).singularValues();
        EXPECT_LT(values(0) / values(values.size() - 1), 33) << n;  // seen 25 .. 31
    }
}

TEST(IntervalMatrices, TheBandedFactorsStayBounded) {
    for (const int n : {5, 6, 7, 20, 64, 200}) {
        Matrix t = interleavedMatrix(n);
        const int size = static_cast<int>(t.rows());
        for (int i = 0; i < size; ++i)
            for (int j = 0; j < size; ++j)
                if (std::abs(i - j) > kBandwidth) {
                    EXPECT_EQ(t(i, j), 0) << n;
                }
        Real largestL = 0, smallestPivot = 1, largestU = 0;
        for (int k = 0; k < size; ++k) {
            smallestPivot = std::min(smallestPivot, std::abs(t(k, k)));
            for (int j = k; j < size; ++j) largestU = std::max(largestU, std::abs(t(k, j)));
            for (int i = k + 1; i < std::min(size, k + 6); ++i) {
                const Real m = t(i, k) / t(k, k);
                largestL = std::max(largestL, std::abs(m));
                for (int j = k; j < std::min(size, k + 6); ++j) t(i, j) -= m * t(k, j);
            }
        }
        EXPECT_LT(double(largestL), 13.8) << n;
        EXPECT_LT(double(largestU), 1.8) << n;
        EXPECT_GT(double(smallestPivot), 0.07) << n;
    }
}

TEST(IntervalMatrices, RecoveryIsTheInverseOfAnalysis) {
    for (int n = 1; n <= 20; ++n) {
        const int size = 2 * n + 3;
        const Matrix a = analysisMap(n), s = synthesisMap(n);
        const Matrix product = s.middleCols(1, size) * a.middleCols(1, size);
        EXPECT_LT(double((product - Matrix::Identity(size, size)).cwiseAbs().maxCoeff()), 1e-16) << n;
        const Matrix leftOver = s.col(0) + s.middleCols(1, size) * a.col(0);
        EXPECT_LT(double(leftOver.cwiseAbs().maxCoeff()), 1e-16) << n;
    }
}

TEST(Interval, AgreesWithTheOracle) {
    std::ifstream file(ISOWAVE_TEST_DATA "/oracle/intervals.json");
    ASSERT_TRUE(file);
    const auto cases = nlohmann::json::parse(file);
    ASSERT_EQ(cases.size(), 28u);
    for (const auto& c : cases) {
        const auto fine = c["fine"].get<std::vector<double>>();
        const Result r = analysed(fine, c["left"], c["right"]);
        // The oracle's own wavelets come from an SVD and carry errors of 1e-12.
        EXPECT_LT(largestDifference(r.coarse, c["coarse"]), 1e-11) << fine.size();  // seen 2e-13
        EXPECT_LT(largestDifference(r.detail, c["detail"]), 1e-11) << fine.size();  // seen 2e-12
    }
}

TEST(Interval, RoundTripIsWithinTheStatedBoundForEveryLength) {
    std::mt19937 rng(1);
    for (int n = 1; n <= 300; ++n)
        for (const double left : {-1.0, 1.0})
            for (const double right : {-1.0, 1.0}) {
                const auto fine = randomLine(n, rng);
                const auto back = synthesised(analysed(fine, left, right), left, right);
                EXPECT_LT(largestDifference(fine, back), kRoundTrip) << n;  // seen 2e-14
            }
}

TEST(Interval, ManyStepsOfOneLineComeBackToTwelveDigits) {
    // 18 steps of the same code on doubles, as a pyramid would take them.
    std::mt19937 rng(5);
    const auto fine = randomLine(2000, rng);
    std::vector<Result> stack;
    std::vector<double> line = fine;
    for (int step = 0; step < 18; ++step) {
        if (line.size() % 2 == 0) line.push_back(1.0);  // an accessory point makes the end odd
        stack.push_back(analysed(line, -1, 1));
        line = stack.back().coarse;
    }
    EXPECT_EQ(line.size(), 4u);
    for (; !stack.empty(); stack.pop_back()) {
        stack.back().coarse.assign(line.begin(), line.begin() + stack.back().coarse.size());
        line = synthesised(stack.back(), -1, 1);
    }
    EXPECT_LT(largestDifference(fine, line), 1e-12);  // seen 1e-13
}

TEST(Interval, AConstantStaysConstant) {
    for (int n = 1; n <= 100; ++n) {
        const Result r = analysed(std::vector<double>(2 * n + 3, 0.7), 0.7, 0.7);
        for (const double c : r.coarse) EXPECT_NEAR(c, 0.7, 1e-13);
        for (const double d : r.detail) EXPECT_NEAR(d, 0, 1e-13);
    }
}

TEST(Interval, MirroringTheLineMirrorsTheResult) {
    std::mt19937 rng(2);
    for (int n = 1; n <= 100; ++n) {
        const auto fine = randomLine(n, rng);
        const Result r = analysed(fine, -1, 1);
        Result m = analysed({fine.rbegin(), fine.rend()}, 1, -1);
        std::reverse(m.coarse.begin(), m.coarse.end());
        std::reverse(m.detail.begin(), m.detail.end());
        EXPECT_LT(largestDifference(r.coarse, m.coarse), 1e-13) << n;
        EXPECT_LT(largestDifference(r.detail, m.detail), 1e-13) << n;
    }
}

TEST(Interval, TheBandedPathAgreesWithTheDenseMap) {
    std::mt19937 rng(3);
    for (const int n : {17, 18, 19, 40, 59, 60, 61, 62, 75, 120}) {
        const auto fine = randomLine(n, rng);
        const Result r = analysed(fine, -1, 1);
        Matrix input(2 * n + 5, 1);
        input(0, 0) = -1;
        input(2 * n + 4, 0) = 1;
        for (int i = 0; i < 2 * n + 3; ++i) input(i + 1, 0) = fine[i];
        const Matrix expected = analysisMap(n) * input;
        for (int j = 0; j < n + 3; ++j) EXPECT_NEAR(r.coarse[j], double(expected(j, 0)), 1e-13) << n;
        for (int k = 0; k < n; ++k) EXPECT_NEAR(r.detail[k], double(expected(n + 3 + k, 0)), 1e-13) << n;
    }
}

TEST(Interval, ResultsDoNotDependOnEarlierCalls) {
    std::mt19937 rng(4);
    const auto line = randomLine(30, rng), longer = randomLine(200, rng);
    IntervalTransform used;
    Result ignored{std::vector<double>(203), std::vector<double>(200)};
    used.analyse(longer, 1, 1, ignored.coarse, ignored.detail);
    Result r{std::vector<double>(33), std::vector<double>(30)};
    used.analyse(line, -1, 1, r.coarse, r.detail);
    const Result fresh = analysed(line, -1, 1);
    EXPECT_EQ(r.coarse, fresh.coarse);
    EXPECT_EQ(r.detail, fresh.detail);
}

// gtest has a Run of its own inside a test.
using Runs = std::vector<Run>;

TEST(Interval, EndsMoveOutwardsToOddPositions) {
    std::vector<Interval> out;
    const Runs runs = {{-4, 2}, {21, 27}};
    joinRuns(runs, out);
    EXPECT_EQ(out, (std::vector<Interval>{{-5, 3}, {21, 27}}));
    EXPECT_EQ(out[0].coarseIntervals(), 3);
    EXPECT_EQ(out[0].firstCoarse(), -3);
    EXPECT_EQ(out[0].lastCoarse(), 2);
    EXPECT_EQ(out[0].lastCoarse() - out[0].firstCoarse() + 1, out[0].coarseSize());
}

TEST(Interval, JoinsRunsWhoseOddEndsAreFourApart) {
    std::vector<Interval> out;
    joinRuns(Runs{{1, 5}, {9, 13}}, out);  // odd ends 5 and 9: four apart
    EXPECT_EQ(out, (std::vector<Interval>{{1, 13}}));
    joinRuns(Runs{{1, 5}, {11, 15}}, out);  // six apart
    EXPECT_EQ(out, (std::vector<Interval>{{1, 5}, {11, 15}}));
    joinRuns(Runs{{1, 6}, {12, 15}}, out);  // 6 -> 7, 12 -> 11: four apart
    EXPECT_EQ(out, (std::vector<Interval>{{1, 15}}));
    joinRuns(Runs{{1, 4}, {6, 9}}, out);  // both ends move to 5: they meet
    EXPECT_EQ(out, (std::vector<Interval>{{1, 9}}));
}

TEST(Interval, ShortestRunKeepsFourControlPointsForEver) {
    // 4 known points, at either parity, have 4 coarse ones: a node stays a node.
    std::vector<Interval> out;
    for (const std::int64_t first : {0, 1}) {
        joinRuns(Runs{{first, first + 3}}, out);
        EXPECT_EQ(out[0].coarseSize(), 4) << first;
        EXPECT_EQ(out[0].detailSize(), 1) << first;
    }
}

}  // namespace
}  // namespace isowave::wavelets
