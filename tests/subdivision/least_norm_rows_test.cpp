#include "subdivision/meshes/least_norm_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "subdivision/meshes/mesh_files.h"
#include "subdivision/meshes/triangle_step.h"

namespace isowave::subdivision {
namespace {

using Family = TriangleStep::Family;
using Fit = TriangleStep::Fit;

// The row of a window whose fine nodes are 0, 1, 2, ...
std::vector<double> rowOf(const std::vector<Taps>& p) {
    LeastNormRows solver([&](Index fine, Taps& row) { row = p[fine]; });
    std::vector<Index> window(p.size());
    for (Index k = 0; k < p.size(); ++k) window[k] = k;
    return solver.weights(window);
}

TEST(LeastNormRows, AreTheWindowsLeastSquaresFit) {
    // One unknown, seen twice at 1 and once at 2: (1, 1, 2)/6.
    const auto row = rowOf({{{0, 1}}, {{0, 1}}, {{0, 2}}});
    ASSERT_EQ(row.size(), 3u);
    EXPECT_NEAR(row[0], 1.0 / 6, 1e-15);
    EXPECT_NEAR(row[1], 1.0 / 6, 1e-15);
    EXPECT_NEAR(row[2], 1.0 / 3, 1e-15);
}

TEST(LeastNormRows, AreEmptyWhereTheWindowDoesNotTellTheVertexFromOthers) {
    EXPECT_TRUE(rowOf({{{0, 1}, {1, 1}}, {{0, 2}, {1, 2}}}).empty());
}

TEST(LeastNormRows, NeedOnlyTheVerticesOwnColumnToBeIndependent) {
    // 1 and 2 are always seen together; 0 is what is left of them.
    const auto row = rowOf({{{0, 1}, {1, 1}, {2, 1}}, {{1, 1}, {2, 1}}});
    ASSERT_EQ(row.size(), 2u);
    EXPECT_NEAR(row[0], 1, 1e-14);
    EXPECT_NEAR(row[1], -1, 1e-14);
}

// Columns 1 and 2 differ by d in the last node only: x0 = 1, x0 + x1 + x2 = 0 and x0 + x1 + (1 + d) x2 = 0 have the
// one solution (1, -1, 0). Taken for dependent, they give (1, -1/2, -1/2), which misses the last equation by d/2.
TEST(LeastNormRows, SolveEquationsThatAreNearlyDependent) {
    for (const double d : {1e-3, 1e-5, 1e-7, 1e-9}) {
        const auto row = rowOf({{{0, 1}, {1, 1}, {2, 1}}, {{1, 1}, {2, 1}}, {{1, 1}, {2, 1 + d}}});
        ASSERT_EQ(row.size(), 3u) << d;
        EXPECT_NEAR(row[0], 1, 1e-15) << d;
        EXPECT_NEAR(row[1] + row[2], -1, 1e-15) << d;
        EXPECT_NEAR(row[1] + (1 + d) * row[2], -1, 1e-15) << d;
    }
}

struct Worst {
    double equation = 0, longest = 0;
};

// What A P misses of I, and the longest row of A.
Worst worstRows(const TriangleStep& step) {
    Worst worst;
    Taps a, p;
    for (Index v = 0; v < step.coarseSize(); ++v) {
        step.rowOfA(v, a);
        std::map<Index, double> product{{v, -1}}, gathered;
        for (const auto& [fine, weight] : a) {
            step.rowOfP(fine, p);
            for (const auto& [coarse, share] : p) product[coarse] += weight * share;
            gathered[fine] += weight;
        }
        double square = 0;
        for (const auto& [coarse, value] : product)
            worst.equation = std::max(worst.equation, std::abs(value));
        for (const auto& [fine, weight] : gathered) square += weight * weight;
        worst.longest = std::max(worst.longest, std::sqrt(square));
    }
    return worst;
}

// A gear of a CAD program: valences from 3 to 24 side by side, whose windows have singular values down to 1e-7.
TEST(LeastNormRows, InvertButterflyOnARealPart) {
    const auto mesh = readPolygonMesh(ISOWAVE_TEST_DATA "/meshes/pinion.off");
    for (const Fit fit : {Fit::Refined, Fit::Wide}) {
        const auto worst = worstRows(TriangleStep(Family::Butterfly, fit, mesh));
        EXPECT_LT(worst.equation, 1e-11);     // seen 2e-12
        EXPECT_LE(worst.longest, 1 + 1e-12);  // A0's row is in every window, and is as long as 1
    }
}

}  // namespace
}  // namespace isowave::subdivision
