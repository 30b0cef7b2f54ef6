// The promises of wavelets/columns.h and of what a column is made of, line_bits.h, line_plan.h and
// line_values.h: beside twins that go point by point.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "tests/wavelets/interval/vector_widths.h"
#include "wavelets/columns.h"
#include "wavelets/interval/interval.h"
#include "wavelets/line_plan.h"
#include "wavelets/line_values.h"

namespace isowave::wavelets {
namespace {

// ---- bits

bool bitOf(const LeafWords& words, int offset) { return words[offset >> 6] >> (offset & 63) & 1; }
bool bitOf(const LeafLines& lines, int line, int position) {
    return lines[line >> 3] >> (8 * (line & 7) + position) & 1;
}
void setBit(LeafLines& lines, int line, int position) {
    lines[line >> 3] |= Word{1} << (8 * (line & 7) + position);
}

LeafWords randomWords(std::mt19937_64& rng) {
    LeafWords words;
    for (Word& w : words) w = rng();
    return words;
}

TEST(LineBits, LinesOfALeafAreItsBitsAlongEachAxisAndComeBack) {
    std::mt19937_64 rng(5);
    for (int axis = 0; axis < 3; ++axis) {
        const LeafWords words = randomWords(rng);
        const LeafLines lines = linesOf(words, axis);
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                for (int z = 0; z < 8; ++z) {
                    const int line = axis == 0 ? 8 * y + z : axis == 1 ? 8 * x + z : 8 * x + y;
                    const int position = axis == 0 ? x : axis == 1 ? y : z;
                    ASSERT_EQ(offsetOf(axis, line, position), 64 * x + 8 * y + z);
                    ASSERT_EQ(bitOf(lines, line, position), bitOf(words, 64 * x + 8 * y + z)) << axis;
                }
        EXPECT_EQ(wordsOfLines(lines, axis), words);
    }
}

TEST(LineBits, EvenBitsAreEveryOtherOne) {
    std::mt19937_64 rng(7);
    for (int trial = 0; trial < 50; ++trial) {
        const Word w = rng();
        for (int i = 0; i < 32; ++i) ASSERT_EQ(evenBits(w) >> i & 1, w >> 2 * i & 1);
    }
}

TEST(LineBits, EvenPositionsOfTwoLeavesMakeOne) {
    std::mt19937_64 rng(8);
    for (int axis = 0; axis < 3; ++axis) {
        const LeafWords low = randomWords(rng), high = randomWords(rng),
                        even = evenPositions(low, high, axis);
        for (int line = 0; line < kLinesPerLeaf; ++line)
            for (int i = 0; i < 8; ++i)
                ASSERT_EQ(bitOf(even, offsetOf(axis, line, i)),
                          bitOf(i < 4 ? low : high, offsetOf(axis, line, 2 * i % 8)))
                    << axis;
    }
}

// ---- intervals

class LinePlans : public testing::TestWithParam<Vectors> {};
INSTANTIATE_TEST_SUITE_P(Widths, LinePlans, testing::ValuesIn(vectorWidths()), vectorsName);

using Known = std::vector<std::vector<bool>>;  // by line and position

std::vector<LeafLines> leavesOf(const Known& known) {
    std::vector<LeafLines> leaves(known[0].size() / kLeafDim);
    for (int line = 0; line < kLinesPerLeaf; ++line)
        for (std::size_t i = 0; i < known[line].size(); ++i)
            if (known[line][i]) setBit(leaves[i / kLeafDim], line, static_cast<int>(i % kLeafDim));
    return leaves;
}

std::vector<Run> runsOf(const std::vector<bool>& known) {
    std::vector<Run> runs;
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(known.size()); ++i)
        if (known[i] && !runs.empty() && runs.back().last == i - 1)
            runs.back().last = i;
        else if (known[i])
            runs.push_back({i, i});
    return runs;
}

// Runs of four or more, anywhere but in the first and the last leaf; ends and gaps of every kind, leaves'
// ends among them.
Known randomRuns(int leaves, std::mt19937& rng) {
    Known known(kLinesPerLeaf, std::vector<bool>(leaves * kLeafDim));
    const int end = (leaves - 1) * kLeafDim;
    for (auto& line : known)
        for (int at = kLeafDim + static_cast<int>(rng() % 12); at + 4 <= end;) {
            const int length = 4 + static_cast<int>(rng() % (rng() % 4 ? 9 : 90));
            for (int i = at; i < std::min(at + length, end); ++i) line[i] = true;
            at += length + 1 + static_cast<int>(rng() % 9);
        }
    return known;
}

TEST_P(LinePlans, IntervalsAreThoseOfJoinedRunsLineByLine) {
    std::mt19937 rng(1);
    LinePlan plan(GetParam());
    for (const int leaves : {4, 6, 8, 10, 16, 18, 40, 4}) {
        const Known known = randomRuns(leaves, rng);
        plan.make(leavesOf(known));
        ASSERT_FALSE(plan.hasShortRun());
        std::vector<std::tuple<int, std::int64_t, std::int64_t>> expected, found;
        Known coarse(kLinesPerLeaf, std::vector<bool>(leaves / 2 * kLeafDim)), stored = coarse;
        for (int line = 0; line < kLinesPerLeaf; ++line) {
            std::vector<Interval> intervals;
            joinRuns(runsOf(known[line]), intervals);
            for (const Interval& i : intervals) {
                expected.emplace_back(line, i.first, i.last);
                for (std::int64_t c = i.firstCoarse(); c <= i.lastCoarse(); ++c) coarse[line][c] = true;
                for (std::int64_t d = 0; d < i.detailSize(); ++d) stored[line][i.firstDetail() + d] = true;
            }
        }
        plan.forEachInterval([&](const LineRun& i) { found.emplace_back(i.line, i.first, i.last); });
        ASSERT_GT(expected.size(), 32u);
        ASSERT_EQ(found, expected) << leaves;
        const auto coarseLeaves = leavesOf(coarse), storedLeaves = leavesOf(stored);
        for (int k = 0; k < leaves / 2; ++k) {
            ASSERT_EQ(plan.coarseKnown(k), coarseLeaves[k]) << leaves << ' ' << k;
            ASSERT_EQ(plan.stored(k), storedLeaves[k]) << leaves << ' ' << k;
        }
    }
}

TEST_P(LinePlans, AShortRunIsFoundWhereverItLies) {
    std::mt19937 rng(2);
    LinePlan plan(GetParam());
    for (int trial = 0; trial < 300; ++trial) {
        const int leaves = 4 + 2 * (trial % 9), length = 1 + trial % 3;
        Known known(kLinesPerLeaf, std::vector<bool>(leaves * kLeafDim));
        const int at = kLeafDim + static_cast<int>(rng() % ((leaves - 2) * kLeafDim - length));
        const int line = static_cast<int>(rng() % kLinesPerLeaf);
        for (int i = at; i < at + length; ++i) known[line][i] = true;
        plan.make(leavesOf(known));
        ASSERT_TRUE(plan.hasShortRun()) << at << ' ' << length;
        const LineRun run = plan.shortRun();
        EXPECT_EQ(std::tuple(run.line, run.first, run.last), std::tuple(line, at, at + length - 1));
    }
}

// ---- values

class ValuesOfLines : public testing::TestWithParam<Vectors> {};
INSTANTIATE_TEST_SUITE_P(Widths, ValuesOfLines, testing::ValuesIn(vectorWidths()), vectorsName);

TEST_P(ValuesOfLines, ALeafsValuesLieAlongTheLinesAndComeBackWhereTheyAreKnown) {
    std::mt19937_64 rng(3);
    LineValues lines(GetParam());
    for (const int leaves : {2, 5, 3})
        for (int axis = 0; axis < 3; ++axis) {
            lines.reset(leaves);
            std::vector<std::array<float, 512>> values(leaves);
            for (int k = 0; k < leaves; ++k) {
                for (float& v : values[k]) v = static_cast<float>(rng() % 100000) - 50000;
                lines.putLeaf(k, axis, values[k].data());
            }
            for (int line = 0; line < kLinesPerLeaf; ++line)
                for (int i = 0; i < leaves * kLeafDim; ++i)
                    ASSERT_EQ(lines.line(line)[i], values[i / 8][offsetOf(axis, line, i % 8)]) << axis;
            for (int k = 0; k < leaves; ++k) {
                const LeafWords known = randomWords(rng), inside = randomWords(rng);
                std::array<float, 512> back;
                lines.takeLeaf(k, axis, known, inside, 4, back.data());
                for (int i = 0; i < 512; ++i)
                    ASSERT_EQ(back[i], bitOf(known, i)    ? values[k][i]
                                       : bitOf(inside, i) ? -4.0f
                                                          : 4.0f)
                        << axis << ' ' << i;
            }
            lines.fillLeaf(1, 7);
            EXPECT_EQ(lines.line(13)[8], 7);
            EXPECT_EQ(lines.line(63)[15], 7);
            EXPECT_EQ(lines.line(63)[7], values[0][offsetOf(axis, 63, 7)]);
        }
}

// ---- columns

TEST(ColumnsOfATree, HoldEveryLeafOnceAndEndWhereFourAreMissing) {
    std::mt19937 rng(4);
    openvdb::BoolTree tree(false);
    std::map<openvdb::Coord, bool> placed;
    for (int i = 0; i < 600; ++i) {  // dense, sparse, across nodes of all sizes, on both sides of the origin
        const int reach = i % 3 == 0 ? 12 : i % 3 == 1 ? 60 : 1200;
        openvdb::Coord c;
        for (int a = 0; a < 3; ++a) c[a] = 8 * (static_cast<int>(rng() % (2 * reach)) - reach);
        if (i % 3 == 2) c[i % 2] = 8 * (i % 5), c[2] = -8 * (i % 4);
        tree.touchLeaf(c);
        placed[c] = true;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const Columns columns(tree, axis);
        std::map<openvdb::Coord, int> seen;
        std::map<std::pair<int, int>, std::int64_t> endOf;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const Column& column = columns[i];
            ASSERT_FALSE(column.leaves.empty());
            ASSERT_TRUE(column.leaves.front() && column.leaves.back());
            int missing = 0;
            for (std::int64_t k = 0; k < static_cast<std::int64_t>(column.leaves.size()); ++k) {
                const auto* leaf = column.leaves[k];
                missing = leaf ? 0 : missing + 1;
                ASSERT_LT(missing, Columns::kGap);
                if (leaf) {
                    ASSERT_EQ(leaf->origin(), column.origin(axis, column.first + k));
                    ++seen[leaf->origin()];
                }
            }
            const std::pair uv(column.u, column.v);
            if (endOf.count(uv)) {
                EXPECT_GE(column.first - endOf[uv], Columns::kGap);
            }
            endOf[uv] = column.end();
        }
        ASSERT_EQ(seen.size(), placed.size());
        // Blocks: columns under one internal node, which no other block has; one range behind the other.
        std::map<std::pair<int, int>, int> blockOf;
        std::size_t next = 0;
        for (const Columns::Range& block : columns.blocks()) {
            ASSERT_EQ(block.begin, next);
            ASSERT_LT(block.begin, block.end);
            const auto nodeOf = [&](std::size_t i) {
                constexpr int kNodeDim = 16 * kLeafDim;
                return std::pair(columns[i].u & ~(kNodeDim - 1), columns[i].v & ~(kNodeDim - 1));
            };
            ASSERT_EQ(++blockOf[nodeOf(block.begin)], 1);
            const auto placeOf = [&](std::size_t i) {
                return std::tuple(columns[i].u, columns[i].v, columns[i].first);
            };
            for (std::size_t i = block.begin + 1; i < block.end; ++i) {
                ASSERT_EQ(nodeOf(i), nodeOf(block.begin));
                ASSERT_LT(placeOf(i - 1), placeOf(i));
            }
            next = block.end;
        }
        EXPECT_EQ(next, columns.size());
        for (const auto& [origin, times] : seen) EXPECT_EQ(times, 1) << origin;
    }
}

}  // namespace
}  // namespace isowave::wavelets
