#include "polygonize/persistence.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

namespace isowave {
namespace {

// dimension, birth, death
using Interval = std::tuple<int, float, float>;

std::vector<Interval> intervalsOf(const LatticeFunction& f, float at, float last) {
    std::vector<Interval> result;
    for (const PersistentClass& c : classesAt(f, at, last)) {
        EXPECT_EQ(f.values[c.birthPoint], c.birth);
        const bool ends = c.deathPoint != PersistentClass::kNever;
        EXPECT_EQ(ends ? f.values[c.deathPoint] : INFINITY, c.death);
        result.emplace_back(c.dimension, c.birth, c.death);
    }
    std::sort(result.begin(), result.end());
    return result;
}

// The textbook: every cell in the order of (value, dimension), its boundary a column, columns reduced from
// the left.
std::vector<Interval> textbook(const LatticeFunction& f, float at) {
    struct Cell {
        std::array<int, 3> at;  // doubled
        int dimension;
        float value;
    };
    std::vector<Cell> cells;
    for (int x = 0; x < 2 * f.size[0] - 1; ++x)
        for (int y = 0; y < 2 * f.size[1] - 1; ++y)
            for (int z = 0; z < 2 * f.size[2] - 1; ++z) {
                float value = -INFINITY;
                for (int i = x / 2; i <= (x + 1) / 2; ++i)
                    for (int j = y / 2; j <= (y + 1) / 2; ++j)
                        for (int k = z / 2; k <= (z + 1) / 2; ++k)
                            value = std::max(value, f.values[f.index(i, j, k)]);
                cells.push_back({{x, y, z}, x % 2 + y % 2 + z % 2, value});
            }
    std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) {
        return std::tie(a.value, a.dimension) < std::tie(b.value, b.dimension);
    });
    std::map<std::array<int, 3>, std::size_t> position;
    for (std::size_t i = 0; i < cells.size(); ++i) position[cells[i].at] = i;
    std::vector<Interval> result;
    std::vector<std::set<std::size_t>> columns(cells.size());
    std::map<std::size_t, std::size_t> columnOf;  // by last row
    std::vector<bool> paired(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        for (int a = 0; a < 3; ++a)
            if (cells[i].at[a] % 2)
                for (const int s : {-1, 1}) {
                    auto face = cells[i].at;
                    face[a] += s;
                    columns[i].insert(position.at(face));
                }
        while (!columns[i].empty() && columnOf.count(*columns[i].rbegin()))
            for (const std::size_t row : columns[columnOf[*columns[i].rbegin()]])
                if (!columns[i].insert(row).second) columns[i].erase(row);
        if (columns[i].empty()) continue;
        const std::size_t birth = *columns[i].rbegin();
        columnOf[birth] = i;
        paired[i] = paired[birth] = true;
        if (cells[birth].value <= at && at < cells[i].value)
            result.emplace_back(cells[birth].dimension, cells[birth].value, cells[i].value);
    }
    for (std::size_t i = 0; i < cells.size(); ++i)
        if (!paired[i] && cells[i].value <= at)
            result.emplace_back(cells[i].dimension, cells[i].value, INFINITY);
    std::sort(result.begin(), result.end());
    return result;
}

template <class F>
LatticeFunction sampled(const openvdb::Coord& size, const F& value) {
    LatticeFunction f{size, {}};
    for (int x = 0; x < size[0]; ++x)
        for (int y = 0; y < size[1]; ++y)
            for (int z = 0; z < size[2]; ++z) f.values.push_back(static_cast<float>(value(x, y, z)));
    return f;
}

TEST(Persistence, AgreesWithTheTextbookOnNoise) {
    std::mt19937 random(3);
    int classes[3] = {0, 0, 0};
    for (int round = 0; round < 60; ++round) {
        const auto upTo = [&](unsigned n) { return static_cast<int>(2 + random() % n); };
        const openvdb::Coord size(upTo(7), upTo(7), upTo(7));
        const int levels = round % 2 ? 6 : 1 << 20;  // many equal values, or none
        const LatticeFunction f =
            sampled(size, [&](int, int, int) { return static_cast<double>(random() % levels) / levels; });
        for (const float at : {0.2f, 0.45f, 0.7f, 0.9f}) {
            const auto found = intervalsOf(f, at, 2);
            EXPECT_EQ(found, textbook(f, at)) << "round " << round << " at " << at;
            for (const auto& [dimension, birth, death] : found) ++classes[dimension];
        }
    }
    EXPECT_GT(classes[0], 300);  // the noise has all of them
    EXPECT_GT(classes[1], 300);
    EXPECT_GT(classes[2], 10);  // seen 14
}

TEST(Persistence, StopsAtTheLastValue) {
    std::mt19937 random(4);
    const LatticeFunction f =
        sampled({7, 6, 8}, [&](int, int, int) { return static_cast<double>(random() % 1000) / 1000; });
    // Parts and handles that end later never end. (Cavities need what fills them.)
    std::vector<Interval> expected;
    for (auto [dimension, birth, death] : textbook(f, 0.4f))
        if (dimension < 2) expected.emplace_back(dimension, birth, death > 0.6f ? INFINITY : death);
    std::sort(expected.begin(), expected.end());
    std::vector<Interval> found;
    for (const auto& interval : intervalsOf(f, 0.4f, 0.6f))
        if (std::get<0>(interval) < 2) found.push_back(interval);
    EXPECT_EQ(found, expected);
}

TEST(Persistence, KnowsATorusAndAShell) {
    const auto torus = [](double x, double y, double z) {
        return std::hypot(std::hypot(x - 15, y - 15) - 9, z - 7) - 3;
    };
    const auto ring = intervalsOf(sampled({31, 31, 15}, torus), 0, 5);
    ASSERT_EQ(ring.size(), 2u);
    EXPECT_EQ(std::get<2>(ring[0]), INFINITY);
    EXPECT_EQ(std::get<0>(ring[1]), 1);
    EXPECT_NEAR(std::get<1>(ring[1]), -3, 0.7);
    EXPECT_EQ(std::get<2>(ring[1]), INFINITY) << "the hole has radius 6";
    const auto whole = intervalsOf(sampled({31, 31, 15}, torus), 0, 8);
    ASSERT_EQ(whole.size(), 2u);
    EXPECT_NEAR(std::get<2>(whole[1]), 6, 0.7);
    const auto shell = intervalsOf(
        sampled({25, 25, 25}, [](double x, double y,
                                 double z) { return std::abs(std::hypot(x - 12, y - 12, z - 12) - 7) - 2; }),
        0, 9);
    ASSERT_EQ(shell.size(), 2u);
    EXPECT_EQ(std::get<0>(shell[1]), 2);
    EXPECT_NEAR(std::get<1>(shell[1]), -2, 1);
    EXPECT_EQ(std::get<2>(shell[1]), 5);
}

TEST(Persistence, DoesNotDependOnTheNumberOfThreads) {
    std::mt19937 random(5);
    const LatticeFunction f =
        sampled({24, 25, 26}, [&](int, int, int) { return static_cast<double>(random() % 5000); });
    std::vector<Interval> first;
    for (const int threads : {1, 2, 4}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const auto found = intervalsOf(f, 2000, 5000);
        if (threads == 1) first = found;
        EXPECT_EQ(found, first);
    }
    EXPECT_GT(first.size(), 500u);
}

TEST(Persistence, CanBeCancelled) {
    const LatticeFunction f = sampled({20, 20, 20}, [&](int x, int, int) { return x; });
    EXPECT_THROW(classesAt(f, 0, 30, {{}, [] { return true; }}), Cancelled);
}

}  // namespace
}  // namespace isowave
