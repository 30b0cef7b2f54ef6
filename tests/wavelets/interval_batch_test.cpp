// The promises of wavelets/interval_batch.h and line_bits.h.
#include "wavelets/interval_batch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>
#include <vector>

#include "wavelets/interval.h"
#include "wavelets/line_bits.h"

namespace isowave::wavelets {
namespace {

constexpr int kLanes = IntervalBatch::kLanes;

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

void put(IntervalBatch& batch, int lane, int row, double value) {
    batch.rows()[row * kLanes + lane] = static_cast<float>(value);
}
float get(IntervalBatch& batch, int lane, int row) { return batch.rows()[row * kLanes + lane]; }

// 12 and 13: the last short length and the first banded one; 60 and 61: the last with factors of its own.
const int kLengths[] = {1, 2, 3, 4, 5, 8, 11, 12, 13, 14, 20, 33, 59, 60, 61, 62, 75, 200};

TEST(IntervalBatch, EveryLaneIsWhatOneIntervalGivesToTheBit) {
    std::mt19937 rng(1);
    IntervalBatch batch;
    for (const int n : kLengths)
        for (const int lanes : {kLanes, 3, 1}) {
            std::vector<Line> lines;
            for (int lane = 0; lane < lanes; ++lane) lines.push_back(randomLine(n, rng));
            batch.start(n, lanes);
            for (int lane = 0; lane < lanes; ++lane) {
                put(batch, lane, 0, lines[lane].left);
                for (int j = 0; j < 2 * n + 3; ++j) put(batch, lane, 1 + j, lines[lane].fine[j]);
                put(batch, lane, 2 * n + 4, lines[lane].right);
            }
            batch.analyse();
            for (int lane = 0; lane < lanes; ++lane) {
                std::vector<double> coarse(n + 3), detail(n);
                const Line& line = lines[lane];
                IntervalTransform().analyse(line.fine, line.left, line.right, coarse, detail);
                for (int j = 0; j < n + 3; ++j)
                    ASSERT_EQ(get(batch, lane, 2 * j), static_cast<float>(coarse[j])) << n << " " << j;
                for (int k = 0; k < n; ++k)
                    ASSERT_EQ(get(batch, lane, 2 * k + 3), static_cast<float>(detail[k])) << n << " " << k;
            }
        }
}

TEST(IntervalBatch, SynthesisOfEveryLaneIsWhatOneIntervalGivesToTheBit) {
    std::mt19937 rng(2);
    IntervalBatch batch;
    for (const int n : kLengths) {
        std::vector<Line> lines;  // fine: any coefficients, c and d one behind the other
        for (int lane = 0; lane < kLanes; ++lane) lines.push_back(randomLine(n, rng));
        batch.start(n, kLanes);
        for (int lane = 0; lane < kLanes; ++lane) {
            for (int j = 0; j < n + 3; ++j) put(batch, lane, 2 * j, lines[lane].fine[j]);
            for (int k = 0; k < n; ++k) put(batch, lane, 2 * k + 3, lines[lane].fine[n + 3 + k]);
            batch.left()[lane] = lines[lane].left;
            batch.right()[lane] = lines[lane].right;
        }
        batch.synthesise();
        for (int lane = 0; lane < kLanes; ++lane) {
            const Line& line = lines[lane];
            const std::span coefficients(line.fine);
            std::vector<double> fine(2 * n + 3);
            IntervalTransform().synthesise(coefficients.first(n + 3), coefficients.subspan(n + 3), line.left,
                                           line.right, fine);
            for (int j = 0; j < 2 * n + 3; ++j)
                ASSERT_EQ(get(batch, lane, 1 + j), static_cast<float>(fine[j])) << n << " " << j;
        }
    }
}

TEST(IntervalBatch, AMirroredIntervalGivesMirroredResultsToTheBitWhereItIsShort) {
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

TEST(IntervalBatch, WhatALaneHeldBeforeDoesNotMatter) {
    std::mt19937 rng(4);
    IntervalBatch used, fresh;
    for (int n = 40; n >= 1; --n) {  // leaves values behind the rows of the shorter ones
        used.start(n, kLanes);
        std::fill_n(used.rows(), (2 * n + 5) * kLanes, 1e30f);
        used.analyse();
    }
    const Line line = randomLine(20, rng);
    for (IntervalBatch* batch : {&used, &fresh}) {
        batch->start(20, 1);
        for (int j = 0; j < 43; ++j) put(*batch, 0, 1 + j, line.fine[j]);
        batch->analyse();
    }
    for (int row = 0; row <= 44; row += 2) EXPECT_EQ(get(used, 0, row), get(fresh, 0, row)) << row;
}

// ---- bits -----------------------------------------------------------------------------------------------

bool bitOf(const LeafWords& words, int x, int y, int z) { return words[x] >> (8 * y + z) & 1; }

TEST(LineBits, LinesOfALeafAreItsBitsAlongEachAxisAndComeBack) {
    std::mt19937_64 rng(5);
    for (int axis = 0; axis < 3; ++axis) {
        LeafWords words;
        for (Word& w : words) w = rng();
        const LeafLines lines = linesOf(words, axis);
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j)
                for (int at = 0; at < 8; ++at) {
                    const bool bit = axis == 0   ? bitOf(words, at, i, j)
                                     : axis == 1 ? bitOf(words, i, at, j)
                                                 : bitOf(words, i, j, at);
                    ASSERT_EQ(lines[8 * i + j] >> at & 1, bit) << axis;
                }
        EXPECT_EQ(wordsOfLines(lines, axis), words);
    }
}

TEST(LineBits, RunsAreFoundWhereverTheyLie) {
    std::mt19937 rng(6);
    for (int trial = 0; trial < 200; ++trial) {
        const int leaves = 2 + trial % 40, positions = 8 * leaves;
        LineBits bits;
        bits.reset(leaves);
        std::vector<bool> expected(positions);
        for (int i = 0; i < 10; ++i) {
            const int first = static_cast<int>(rng() % (positions - 1));
            const int last = std::min<int>(positions - 2, first + static_cast<int>(rng() % 100));
            bits.set(17, first, std::max(first, last));
            for (int p = first; p <= std::max(first, last); ++p) expected[p] = true;
        }
        expected[positions - 1] = false;
        std::vector<bool> found(positions);
        int before = -2;
        bits.forEachRun(17, [&](int first, int last) {
            ASSERT_GT(first, before + 1) << "runs are maximal";
            for (int p = first; p <= last; ++p) found[p] = true;
            before = last;
        });
        EXPECT_EQ(found, expected);
        bits.forEachRun(16, [](int, int) { FAIL() << "another line"; });
    }
}

TEST(LineBits, EvenBitsAreEveryOtherOne) {
    std::mt19937_64 rng(7);
    for (int trial = 0; trial < 50; ++trial) {
        const Word w = rng();
        for (int i = 0; i < 32; ++i) ASSERT_EQ(evenBits(w) >> i & 1, w >> 2 * i & 1);
    }
}

}  // namespace
}  // namespace isowave::wavelets
