// The promises of wavelets/interval/batch.h and batch_queue.h, for every width of vectors that this machine
// has.
#include "wavelets/interval/batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "tests/wavelets/interval/vector_widths.h"
#include "wavelets/batch_queue.h"
#include "wavelets/interval/interval.h"

namespace isowave::wavelets {
namespace {

struct Line {
    std::vector<double> fine;
    float left, right;
};

Line randomLine(int n, std::mt19937& rng) {
    std::uniform_real_distribution<float> value(-1, 1);
    Line line{std::vector<double>(2 * n + 3), value(rng) < 0 ? -1.0f : 1.0f, value(rng) < 0 ? -1.0f : 1.0f};
    for (double& x : line.fine) x = value(rng);
    return line;
}

constexpr float kGuard = 12345;  // what lies behind a line

// Room for the fine values of each lane with their accessory ones, and for its coefficients; every line with
// what may be read behind it.
struct Lanes {
    std::vector<float> fine[kLanes], coarse[kLanes], detail[kLanes];
    AnalysisBatch analysis;
    SynthesisBatch synthesis;

    Lanes(int n, int lanes) {
        analysis.n = synthesis.n = n;
        analysis.lanes = synthesis.lanes = lanes;
        for (int lane = 0; lane < lanes; ++lane) {
            fine[lane].assign(2 * n + 5 + kSlack, kGuard);
            coarse[lane].assign(n + 3 + kSlack, kGuard);
            detail[lane].assign(n + kSlack, kGuard);
            analysis.fine[lane] = fine[lane].data();
            synthesis.fine[lane] = fine[lane].data() + 1;
            synthesis.coarse[lane] = analysis.coarse[lane] = coarse[lane].data();
            synthesis.detail[lane] = analysis.detail[lane] = detail[lane].data();
        }
    }
    void expectGuards() const {
        for (int lane = 0; lane < analysis.lanes; ++lane)
            for (int i = 1; i <= kSlack; ++i) {
                EXPECT_EQ(fine[lane].end()[-i], kGuard);
                EXPECT_EQ(coarse[lane].end()[-i], kGuard);
                EXPECT_EQ(detail[lane].end()[-i], kGuard);
            }
    }
    void putFine(int lane, const Line& line) {
        fine[lane][0] = line.left;
        for (std::size_t j = 0; j < line.fine.size(); ++j)
            fine[lane][1 + j] = static_cast<float>(line.fine[j]);
        fine[lane][1 + line.fine.size()] = line.right;
    }
};

// 12 and 13: the last short length and the first banded one; 60 and 61: the last with factors of its own.
const int kLengths[] = {1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14, 20, 33, 59, 60, 61, 62, 75, 200};

class IntervalBatch : public testing::TestWithParam<Vectors> {};
INSTANTIATE_TEST_SUITE_P(Widths, IntervalBatch, testing::ValuesIn(vectorWidths()), vectorsName);

TEST_P(IntervalBatch, EveryLaneIsWhatOneIntervalGivesToTheBit) {
    std::mt19937 rng(1);
    BatchTransform transform(GetParam());
    for (const int n : kLengths)
        for (const int lanes : {kLanes, 5, 3, 1}) {
            std::vector<Line> lines;
            for (int lane = 0; lane < lanes; ++lane) lines.push_back(randomLine(n, rng));
            Lanes queue(n, lanes);
            for (int lane = 0; lane < lanes; ++lane) queue.putFine(lane, lines[lane]);
            transform.analyse(queue.analysis);
            for (int lane = 0; lane < lanes; ++lane) {
                std::vector<double> coarse(n + 3), detail(n);
                const Line& line = lines[lane];
                IntervalTransform().analyse(line.fine, line.left, line.right, coarse, detail);
                for (int j = 0; j < n + 3; ++j)
                    ASSERT_EQ(queue.coarse[lane][j], static_cast<float>(coarse[j])) << n << " " << j;
                for (int k = 0; k < n; ++k)
                    ASSERT_EQ(queue.detail[lane][k], static_cast<float>(detail[k])) << n << " " << k;
            }
            queue.expectGuards();
        }
}

TEST_P(IntervalBatch, SynthesisOfEveryLaneIsWhatOneIntervalGivesToTheBit) {
    std::mt19937 rng(2);
    BatchTransform transform(GetParam());
    for (const int n : kLengths)
        for (const int lanes : {kLanes, 2}) {
            std::vector<Line> lines;  // fine: any coefficients, c and d one behind the other
            for (int lane = 0; lane < lanes; ++lane) lines.push_back(randomLine(n, rng));
            Lanes queue(n, lanes);
            for (int lane = 0; lane < lanes; ++lane) {
                for (int j = 0; j < n + 3; ++j)
                    queue.coarse[lane][j] = static_cast<float>(lines[lane].fine[j]);
                for (int k = 0; k < n; ++k)
                    queue.detail[lane][k] = static_cast<float>(lines[lane].fine[n + 3 + k]);
                queue.synthesis.left[lane] = lines[lane].left;
                queue.synthesis.right[lane] = lines[lane].right;
            }
            transform.synthesise(queue.synthesis);
            for (int lane = 0; lane < lanes; ++lane) {
                const Line& line = lines[lane];
                const std::span coefficients(line.fine);
                std::vector<double> fine(2 * n + 3);
                IntervalTransform().synthesise(coefficients.first(n + 3), coefficients.subspan(n + 3),
                                               line.left, line.right, fine);
                for (int j = 0; j < 2 * n + 3; ++j)
                    ASSERT_EQ(queue.fine[lane][1 + j], static_cast<float>(fine[j])) << n << " " << j;
                EXPECT_EQ(queue.fine[lane][0], kGuard);
                EXPECT_EQ(queue.fine[lane][2 * n + 4], kGuard);
            }
            queue.expectGuards();
        }
}

TEST_P(IntervalBatch, WhatALaneHeldBeforeDoesNotMatter) {
    std::mt19937 rng(4);
    BatchTransform used(GetParam()), fresh(GetParam());
    for (int n = 40; n >= 1; --n) {  // leaves values behind the rows of the shorter ones
        Lanes queue(n, kLanes);
        for (auto& line : queue.fine)
            std::fill(line.begin(), line.end(), std::numeric_limits<float>::quiet_NaN());
        used.analyse(queue.analysis);
        used.synthesise(queue.synthesis);
    }
    const Line line = randomLine(20, rng);
    std::vector<std::vector<float>> results;
    for (BatchTransform* transform : {&used, &fresh}) {
        Lanes queue(20, 1);
        queue.putFine(0, line);
        transform->analyse(queue.analysis);
        results.push_back(queue.coarse[0]);
        results.push_back(queue.detail[0]);
        queue.synthesis.left[0] = queue.synthesis.right[0] = 1;
        transform->synthesise(queue.synthesis);
        results.push_back(queue.fine[0]);
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(results[i], results[3 + i]);
}

// ---- waiting

struct FakeBatch {
    int n = 0, lanes = 0;
    int ids[kLanes];
};

TEST(BatchQueue, EveryIntervalRunsOnceBesideOthersOfItsLength) {
    constexpr int kSlots = BatchQueue<FakeBatch>::kSlots;
    std::mt19937 rng(5);
    BatchQueue<FakeBatch> queue;
    std::vector<int> lengthOf;
    std::vector<int> timesRun;
    int full = 0, early = 0;
    const auto run = [&](const FakeBatch& batch) {
        ASSERT_GE(batch.lanes, 1);
        ASSERT_LE(batch.lanes, kLanes);
        for (int lane = 0; lane < batch.lanes; ++lane) {
            ASSERT_EQ(lengthOf[batch.ids[lane]], batch.n);
            ++timesRun[batch.ids[lane]];
        }
        (batch.lanes == kLanes ? full : early) += 1;
    };
    for (int round = 0; round < 3; ++round) {
        for (int i = 0; i < 500; ++i) {
            const int id = static_cast<int>(lengthOf.size());
            // 1 .. 5, and some that share a place with one of them
            const int n = 1 + static_cast<int>(rng() % 5) + (rng() % 10 ? 0 : kSlots * (1 + round));
            lengthOf.push_back(n);
            timesRun.push_back(0);
            queue.add(
                n, [&](FakeBatch& batch, int lane) { batch.ids[lane] = id; }, run);
        }
        queue.flush(run);
        EXPECT_EQ(timesRun, std::vector<int>(timesRun.size(), 1)) << "all that waited have run";
    }
    EXPECT_GT(full, 30);
    EXPECT_GT(early, 30);
}

TEST(IntervalTransform, AMirroredIntervalGivesMirroredResultsToTheBitWhereItIsShort) {
    std::mt19937 rng(3);
    for (int n = 1; n <= 12; ++n) {
        Line line = randomLine(n, rng);
        std::vector<double> coarse(n + 3), detail(n), mirroredCoarse(n + 3), mirroredDetail(n);
        IntervalTransform().analyse(line.fine, line.left, line.right, coarse, detail);
        const std::vector<double> mirrored(line.fine.rbegin(), line.fine.rend());
        IntervalTransform().analyse(mirrored, line.right, line.left, mirroredCoarse, mirroredDetail);
        EXPECT_EQ(coarse, std::vector<double>(mirroredCoarse.rbegin(), mirroredCoarse.rend())) << n;
        EXPECT_EQ(detail, std::vector<double>(mirroredDetail.rbegin(), mirroredDetail.rend())) << n;
    }
}

// What every coefficient does alone, by IntervalTransform, with its sign taken away; some of the bounds are negative here,
// and count as much.
TEST(BatchGain, IsTheSumOfWhatEachCoefficientCanDo) {
    std::mt19937 rng(11);
    std::uniform_real_distribution<float> value(-1, 1);
    IntervalTransform one;
    for (int n = 1; n <= 40; ++n) {
        Lanes lanes(n, 1);
        lanes.synthesis.left[0] = lanes.synthesis.right[0] = 1;
        std::vector<double> expected(2 * n + 3), coarse(n + 3), detail(n), fine(2 * n + 3);
        for (int k = 0; k < 2 * n + 3; ++k) {
            double& unit = k < n + 3 ? coarse[k] : detail[k - (n + 3)];
            float& bound = k < n + 3 ? lanes.coarse[0][k] : lanes.detail[0][k - (n + 3)];
            bound = value(rng);
            unit = 1;
            one.synthesise(coarse, detail, 0, 0, fine);
            unit = 0;
            for (int i = 0; i < 2 * n + 3; ++i) expected[i] += std::abs(fine[i]) * std::abs(double(bound));
        }
        BatchTransform().gain(lanes.synthesis);
        for (int i = 0; i < 2 * n + 3; ++i)
            EXPECT_NEAR(lanes.fine[0][i + 1], expected[i], 1e-6 * (1 + expected[i])) << n << ' ' << i;
    }
}

}  // namespace
}  // namespace isowave::wavelets
