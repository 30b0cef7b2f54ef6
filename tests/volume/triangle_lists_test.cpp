#include "volume/distance/triangle_lists.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "volume/distance/sign_changes.h"
#include "volume/mesh_nearest.h"

namespace isowave {
namespace {

using openvdb::Vec3d;

// Triangles in [0, 64)^3, of edges about `size` long; every eleventh is flat, a few are points.
std::vector<TriangleSoup::Corners> soupOf(int count, double size, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(0, 64);
    std::normal_distribution<double> offset(0, size);
    std::vector<TriangleSoup::Corners> corners;
    for (int n = 0; n < count; ++n) {
        TriangleSoup::Corners c;
        for (std::size_t a = 0; a < 3; ++a) {
            c[0][a] = place(random);
            c[1][a] = c[0][a] + offset(random);
            c[2][a] = n % 11 == 0 ? 2 * c[1][a] - c[0][a] : n % 37 == 0 ? c[0][a] : c[0][a] + offset(random);
            if (n % 37 == 0) c[1][a] = c[0][a];
        }
        corners.push_back(c);
    }
    return corners;
}

// The leaf's distances, by halving the block [0, 64)^3 down to it.
std::array<float, 512> descendTo(const std::array<int, 3>& leaf, const TriangleSoup& soup, double reach,
                                 Vectors vectors) {
    TriangleLists lists(soup, reach, vectors);
    TriangleList triangles(soup.size());
    std::iota(triangles.begin(), triangles.end(), 0u);
    std::array<int, 3> origin{};
    for (int size = 32; size >= 8; size /= 2) {
        auto children = lists.split(triangles, origin, size);
        std::size_t child = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const bool upper = leaf[a] >= origin[a] + size;
            child = 2 * child + upper;
            if (upper) origin[a] += size;
        }
        triangles = children[child];
    }
    std::array<float, 512> distances;
    lists.distances(triangles, leaf, distances.data());
    return distances;
}

// Every triangle asked, in double.
double bruteForce(const TriangleHierarchy& one, std::size_t count, const Vec3d& point, double reach) {
    double least = reach * reach;
    for (std::size_t t = 0; t < count; ++t)
        least = std::min(least, one.distanceTo(std::int64_t(t), point).squared);
    return std::sqrt(least);
}

struct Case {
    int count;
    double size, reach;
};

class TriangleListsOf : public testing::TestWithParam<Case> {};

// Large and small triangles, few and many in a leaf, bands of several widths: against every triangle in double.
TEST_P(TriangleListsOf, AreExactAndTheSameWithEveryVector) {
    const auto [count, size, reach] = GetParam();
    const std::vector<TriangleSoup::Corners> corners = soupOf(count, size, 7);
    const TriangleSoup soup(corners);
    std::vector<Vec3d> points;
    std::vector<Triangle> triangles;
    for (const auto& c : corners) {
        const auto first = static_cast<std::uint32_t>(points.size());
        for (const Place& p : c) points.emplace_back(p[0], p[1], p[2]);
        triangles.push_back({first, first + 1, first + 2});
    }
    const TriangleHierarchy all(points, triangles);
    double worst = 0;
    for (const std::array<int, 3> leaf : {std::array{24, 32, 40}, {0, 0, 0}, {56, 8, 16}}) {
        const auto distances = descendTo(leaf, soup, reach, widestVectors());
        EXPECT_EQ(distances, descendTo(leaf, soup, reach, Vectors::two));
        for (int n = 0; n < 512; n += 5) {
            const Vec3d point(leaf[0] + (n >> 6), leaf[1] + (n >> 3 & 7), leaf[2] + (n & 7));
            const double expected = bruteForce(all, corners.size(), point, reach);
            worst = std::max(worst, std::abs(double(distances[std::size_t(n)]) - expected));
        }
    }
    EXPECT_LT(worst,
              4e-6);  // seen 1.2e-7, 1.2e-7, 2.1e-6, 1.2e-7, 2.5e-8, 4.7e-7: rounding, and ties of the lists
}

INSTANTIATE_TEST_SUITE_P(Soups, TriangleListsOf,
                         testing::Values(Case{30, 20, 4}, Case{300, 4, 4}, Case{3000, 2, 4},
                                         Case{20000, 0.3, 4}, Case{300, 4, 1}, Case{200, 10, 9.5}));

// Random signs, of which few or many differ, against every edge in reach.
TEST(SignChanges, AreAsFarAsTheNearestEdgeWhoseEndsDiffer) {
    std::mt19937 random(3);
    for (const unsigned rarity : {2u, 50u, 1000u, 3000u}) {
        LeafSigns signs{};
        constexpr int kSize = LeafSigns::kSize;
        for (auto& plane : signs.rows)
            for (auto& row : plane)
                for (int k = 0; k < kSize; ++k) row |= unsigned(random() % rarity == 0) << k;
        const auto found = toSignChanges(signs);
        const auto at = [&](int i, int j, int k) {
            return signs.rows[std::size_t(i)][std::size_t(j)] >> k & 1;
        };
        for (int n = 0; n < 512; ++n) {
            int least = 1 << 14;
            const int p[3] = {5 + (n >> 6), 5 + (n >> 3 & 7), 5 + (n & 7)};
            for (int i = 0; i < kSize; ++i)
                for (int j = 0; j < kSize; ++j)
                    for (int k = 0; k < kSize; ++k)
                        for (int axis = 0; axis < 3; ++axis) {
                            const int d[3] = {axis == 0, axis == 1, axis == 2};
                            if (i + d[0] >= kSize || j + d[1] >= kSize || k + d[2] >= kSize) continue;
                            if (at(i, j, k) == at(i + d[0], j + d[1], k + d[2])) continue;
                            const int x = 2 * (i - p[0]) + d[0], y = 2 * (j - p[1]) + d[1],
                                      z = 2 * (k - p[2]) + d[2];
                            least = std::min(least, x * x + y * y + z * z);
                        }
            if (least <= kFourfoldReach)
                ASSERT_EQ(found[std::size_t(n)], least) << rarity << ' ' << n;
            else
                ASSERT_GT(found[std::size_t(n)], kFourfoldReach);
        }
    }
}

}  // namespace
}  // namespace isowave
