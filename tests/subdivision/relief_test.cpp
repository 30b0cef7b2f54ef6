// Reliefs: layouts, levels, pictures.
#include "subdivision/lattice/relief.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "isowave/subdivision.h"
#include "subdivision/lattice/grid_files.h"
#include "tests/subdivision/numbers.h"
#include "tests/subdivision/refusal.h"

namespace isowave::subdivision {
namespace {

using testing::HasSubstr;

TEST(Relief, RowsTakeAllAndAMirrorImageAndQuincunxTheMiddle) {
    Grid grid{11, 24, 1, {}};
    for (std::size_t r = 0; r < 11; ++r) {
        for (std::size_t c = 0; c < 24; ++c) grid.values.push_back(static_cast<double>(100 * r + c));
    }
    const SurfaceField rows = reliefField(grid, ReliefLayout::Rows, 2);
    EXPECT_EQ(rows.patch, Patch::parallelogram(24, 12));
    const Grid whole = reliefPicture(rows, ReliefLayout::Rows);
    EXPECT_EQ(whole.at(0, 0), 0);
    EXPECT_EQ(whole.at(3, 5), 305);
    EXPECT_EQ(whole.at(12, 24), 822);  // beside the last row 10 and the last column 23
    EXPECT_EQ(withoutPadding(whole, grid, 0).values, grid.values);
    const SurfaceField hexagon = reliefField(grid, ReliefLayout::Quincunx, 2);
    EXPECT_EQ(hexagon.patch, Patch::hexagon(4));
    EXPECT_EQ(hexagon.values[hexagon.patch.index({0, 0})], 511);
    EXPECT_EQ(hexagon.values[hexagon.patch.index({1, 0})], 513);
    EXPECT_EQ(hexagon.values[hexagon.patch.index({0, 1})], 612);
    const Grid picture = reliefPicture(hexagon, ReliefLayout::Quincunx);
    EXPECT_EQ(picture.at(4, 8), 511);
    EXPECT_EQ(picture.at(4, 9), 512);  // between two samples, their mean
    EXPECT_TRUE(std::isnan(picture.at(0, 0)));
    EXPECT_THAT(complaint([&] { reliefField(grid, ReliefLayout::Rows, 4); }),
                HasSubstr("11 x 24 samples is too small for 4 levels; they need 17 x 17"));
    EXPECT_THAT(complaint([&] { reliefField(grid, ReliefLayout::Quincunx, 3); }),
                HasSubstr("17 rows and 33 columns"));
}

// B section 11 on a real relief: exact with details; without, wider A come closer than dropping samples does.
TEST(Relief, OfATerrainIsExactAndBetterThanDroppingSamples) {
    const Grid grid = readGrid(ISOWAVE_TEST_DATA "/terrain/jacksboro.npy");
    ASSERT_EQ(grid.rows, 161u);
    for (const ReliefLayout layout : {ReliefLayout::Rows, ReliefLayout::Quincunx}) {
        const SurfaceField field = reliefField(grid, layout, 2);
        std::map<std::string, double> suppressed;
        for (const auto& name : surfaceSchemeNames()) {
            SurfaceFilters filters(surfaceScheme(name));
            const SurfaceLevels levels = decompose(field, filters, 2);
            const auto difference = [&](const SurfaceField& other) {
                std::vector<double> d;
                for (std::size_t k = 0; k < field.values.size(); ++k)
                    d.push_back(other.values[k] - field.values[k]);
                return rms(d);
            };
            EXPECT_LT(difference(reconstruct(levels, filters)), 1e-12 * 1040);
            suppressed[name] = difference(subdivided(levels, filters, 2));
            EXPECT_GT(rms(detailField(levels, 0).values), 0);
        }
        for (const auto& [name, error] : suppressed) {
            std::printf("%-10s %-18s details suppressed: rms %.2f m\n",
                        layout == ReliefLayout::Rows ? "rows" : "quincunx", name.c_str(), error);
        }
        EXPECT_LT(suppressed["butterfly-3"], suppressed["butterfly-trivial"]);
        EXPECT_LT(suppressed["butterfly-4"], suppressed["butterfly-3"]);
        EXPECT_LT(suppressed["loop-3"], suppressed["loop-1"]);
    }
}

TEST(Relief, OfATorusOfPointsIsASurfaceInSpace) {
    // A grid of points in 3D, closed both ways: no side at all.
    const Patch patch = Patch::torus(64, 32);
    SurfaceField field{patch, 3, {}};
    for (const Node n : patch.nodes()) {
        const double u = 2 * M_PI * n.x / 64, v = 2 * M_PI * n.y / 32;
        for (const double value :
             {(2 + std::cos(v)) * std::cos(u), (2 + std::cos(v)) * std::sin(u), std::sin(v)})
            field.values.push_back(value);
    }
    SurfaceFilters filters(surfaceScheme("butterfly-3"));
    double last = 1e9;
    for (int levels = 3; levels >= 1;
         --levels) {  // the coarser the base, the larger the error: 16x for a halved step
        const SurfaceLevels parts = decompose(field, filters, levels);
        const auto without = subdivided(parts, filters, levels).values;
        double most = 0;
        for (std::size_t k = 0; k < without.size(); ++k)
            most = std::max(most, std::abs(without[k] - field.values[k]));
        std::printf("torus, %d levels suppressed: largest error %.2e\n", levels, most);
        EXPECT_LT(most, last / 6);
        last = most;
    }
}

TEST(Relief, ShadingIsBetweenDarkAndLight) {
    Grid slope{4, 4, 1, {}};
    for (int k = 0; k < 16; ++k) slope.values.push_back(k % 4);  // rises to the right: towards the light
    Grid flat{4, 4, 1, std::vector<double>(16, 3.0)};
    EXPECT_GT(shaded(slope, 1).at(1, 1), shaded(flat, 1).at(1, 1));
    for (double& value : slope.values) value = -value;
    EXPECT_LT(shaded(slope, 1).at(1, 1), shaded(flat, 1).at(1, 1));
}

TEST(ReliefReport, OfAnySizeComesBackWhole) {
    for (const auto& [rows, columns] :
         {std::pair<std::size_t, std::size_t>{64, 90}, {5, 5}, {6, 5}, {17, 18}}) {
        Grid grid{rows, columns, 1, {}};
        for (std::size_t k = 0; k < rows * columns; ++k)
            grid.values.push_back(std::sin(0.37 * static_cast<double>(k)));
        const ReliefReport report = reportRelief(grid, {.levels = 2});
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(report.levels[k].heights.rows, ((rows - 1) >> k) + 1);
            EXPECT_EQ(report.levels[k].heights.columns, ((columns - 1) >> k) + 1);
        }
        for (std::size_t k = 0; k < grid.values.size(); ++k)
            EXPECT_NEAR(report.levels[0].heights.values[k], grid.values[k], 1e-12);
        EXPECT_EQ(report.suppressed.values.size(), grid.values.size());
    }
}

TEST(ReliefReport, HoldsGridsPicturesAndNumbersOfEveryLevel) {
    const Grid grid = readGrid(ISOWAVE_TEST_DATA "/terrain/jacksboro.npy");
    const ReliefReport report =
        reportRelief(grid, {.scheme = "butterfly-3", .layout = ReliefLayout::Quincunx, .levels = 2});
    ASSERT_EQ(report.levels.size(), 3u);
    EXPECT_EQ(report.levels[0].patch, "hexagon 48");
    EXPECT_LT(report.roundTrip, 1e-12 * 1040);
    EXPECT_LT(report.levels[0].suppressedRms, report.levels[1].suppressedRms);
    EXPECT_LT(report.levels[1].suppressedRms, report.levels[2].suppressedRms);
    EXPECT_EQ(report.levels[0].heights.rows, 97u);
    EXPECT_EQ(report.levels[2].heights.rows, 25u);
    EXPECT_TRUE(report.levels[2].detailLengths.values.empty());
    EXPECT_EQ(report.suppressed.columns, report.levels[0].heights.columns);
    std::set<std::string> names;
    forEachPicture(report, [&](const std::string& name, const Grid& values, double black, double white) {
        names.insert(name);
        EXPECT_FALSE(values.values.empty()) << name;
        if (name != "details_0") return;
        EXPECT_GT(black, white) << "large details are dark";
        EXPECT_EQ(*std::min_element(values.values.begin(), values.values.end(),
                                    [](double a, double b) { return std::isnan(b) || a < b; }),
                  0)
            << "vertex nodes hold no detail";
    });
    EXPECT_EQ(names,
              (std::set<std::string>{"level_0", "shade_0", "details_0", "level_1", "shade_1", "details_1",
                                     "level_2", "shade_2", "suppressed", "suppressed_shade"}));
}

}  // namespace
}  // namespace isowave::subdivision
