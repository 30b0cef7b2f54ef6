// Details of curves and of heights in files, and what they are put together to: curve_details.h, curve_rebuild.h,
// relief_details.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include "base/section_file.h"
#include "isowave/error.h"
#include "subdivision/curves/curve.h"
#include "subdivision/curves/curve_details.h"
#include "subdivision/curves/curve_rebuild.h"
#include "subdivision/lattice/relief.h"
#include "subdivision/lattice/relief_details.h"
#include "tests/subdivision/numbers.h"
#include "tests/subdivision/refusal.h"
#include "tests/temp_folder.h"

namespace isowave::subdivision {
namespace {

using testing::HasSubstr;

// A wavy line of n points around or along, in the plane or in space.
Polyline wavy(std::size_t n, bool closed, int dimension, double wave = 0.05) {
    Polyline curve{dimension, closed, {}};
    for (std::size_t i = 0; i < n; ++i) {
        const double t = 2 * M_PI * static_cast<double>(i) / static_cast<double>(n);
        const double r = 1 + wave * std::sin(17 * t) + 0.3 * wave * std::cos(61 * t);
        curve.coordinates.push_back(closed ? r * std::cos(t) : t);
        curve.coordinates.push_back(closed ? r * std::sin(t) : r);
        if (dimension == 3) curve.coordinates.push_back(0.2 * std::sin(3 * t));
    }
    return curve;
}

CurveSet setOf(const std::vector<Polyline>& curves, const std::string& scheme, int levels) {
    CurveSet set{scheme, "", 0, 0, {}};
    for (const Polyline& curve : curves) {
        const CurveFilters filters(curveScheme(scheme), curve.closed);
        const int most = std::min(levels, filters.mostLevels(curve.size()));
        set.curves.push_back(decompose(curve, filters, most));
        set.levels = std::max(set.levels, most);
    }
    return set;
}

std::vector<Polyline> several() {
    return {wavy(150, true, 2), wavy(97, false, 2), wavy(33, false, 3), wavy(9, true, 2), wavy(2, false, 2)};
}

void expectSame(const CurveSet& a, const CurveSet& b) {
    EXPECT_EQ(a.levels, b.levels);
    ASSERT_EQ(a.curves.size(), b.curves.size());
    for (std::size_t i = 0; i < a.curves.size(); ++i) {
        const CurveLevels &x = a.curves[i], &y = b.curves[i];
        EXPECT_EQ(x.scheme, y.scheme);
        EXPECT_EQ(x.coarse.dimension, y.coarse.dimension);
        EXPECT_EQ(x.coarse.closed, y.coarse.closed);
        EXPECT_EQ(x.coarse.coordinates, y.coarse.coordinates);
        ASSERT_EQ(x.levels(), y.levels());
        for (std::size_t k = 0; k < x.details.size(); ++k) {
            EXPECT_EQ(x.details[k].points, y.details[k].points);
            EXPECT_EQ(x.details[k].coordinates, y.details[k].coordinates);
        }
    }
}

TEST(CurveDetailsFile, KeepsEveryBitForEveryScheme) {
    for (const std::string& scheme : curveSchemeNames()) {
        const CurveSet set = setOf(several(), scheme, 3);
        expectSame(readCurveDetails(curveDetailsBytes(set), "d"), set);
    }
    CurveSet own{"", "1/8 1/2 3/4 1/2 1/8", 7, 2, {}};
    own.curves.push_back(
        decompose(wavy(64, true, 2), CurveFilters(maskScheme(own.mask, own.width), true), 2));
    expectSame(readCurveDetails(curveDetailsBytes(own), "d"), own);
}

TEST(CurveDetailsFile, OfFewDetailsIsSmall) {
    CurveSet set = setOf({wavy(20000, true, 2)}, "dlg-refined", 6);
    const std::size_t whole = curveDetailsBytes(set).size();
    keepLongest(set.curves[0], 200);
    EXPECT_LT(10 * curveDetailsBytes(set).size(), whole);  // seen 17
}

// Every prefix, and every byte changed four times, is refused in one line that names the file.
void expectEveryDamageRefused(const std::string& whole,
                              const std::function<std::string(const std::string&)>& read) {
    ASSERT_EQ(read(whole), "");
    const auto refused = [&](const std::string& bytes, std::size_t at) {
        const std::string line = read(bytes);
        EXPECT_THAT(line, HasSubstr("d.bin: ")) << at;
        EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 0) << line;
    };
    for (std::size_t length = 0; length < whole.size(); ++length) refused(whole.substr(0, length), length);
    refused(whole + "x", whole.size());
    std::mt19937 random(3);
    for (std::size_t run = 0; run < 4 * whole.size(); ++run) {
        std::string damaged = whole;
        const std::size_t at = run % whole.size();
        damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 + random() % 255));
        refused(damaged, at);
    }
}

std::string readingCurves(const std::string& bytes) {
    return complaint([&] { rebuild(readCurveDetails(bytes, "d.bin")); });
}
std::string readingHeights(const std::string& bytes) {
    return complaint([&] { readReliefDetails(bytes, "d.bin"); });
}

// With true checksums: refused or read, never a crash; some of either.
void expectOthersRefusedOrRead(const SectionFormat& format, const std::string& whole,
                               const std::function<std::string(const std::string&)>& read) {
    const std::vector<Section> sections = sectionsOf(format, whole);
    std::mt19937 random(4);
    int refused = 0;
    for (int run = 0; run < 2000; ++run) {
        std::vector<Section> changed = sections;
        std::string& content = changed[random() % 2].content;
        for (std::size_t left = 1 + random() % 3; left > 0; --left)
            content[random() % content.size()] = static_cast<char>(random() % (run % 2 ? 256 : 8));
        refused += !read(fileOf(format, changed)).empty();
    }
    EXPECT_GT(refused, 500);
    std::vector<Section> fewer = sections;
    fewer.pop_back();
    EXPECT_NE(read(fileOf(format, fewer)), "");
}

TEST(CurveDetailsFile, RefusesDamage) {
    const std::string whole =
        curveDetailsBytes(setOf({wavy(12, true, 2), wavy(9, false, 2)}, "dlg-refined", 2));
    expectEveryDamageRefused(whole, readingCurves);
    expectOthersRefusedOrRead({kCurveDetailsMagic, 1, "", "", ""}, whole, readingCurves);
    EXPECT_THAT(readingCurves("0 0\n1 1\n"), HasSubstr("is no file of details of curves"));
}

TEST(CurveRebuild, IsLevelZeroOfTheReportToTheBit) {
    for (const char* scheme : {"dlg-refined", "cubic-7", "chaikin-4"}) {
        const CurveReport report = reportCurves(several(), {.scheme = scheme, .levels = 3, .details = true});
        const CurveSet set = readCurveDetails(report.details, "d");
        for (int depth = 0; depth <= 3; ++depth) {
            const RebuiltCurves rebuilt = rebuild(set, {.depth = depth});
            const auto& expected = report.atLevel[static_cast<std::size_t>(3 - depth)];
            ASSERT_EQ(rebuilt.curves.size(), expected.size());
            for (std::size_t i = 0; i < expected.size(); ++i)
                EXPECT_EQ(rebuilt.curves[i].coordinates, expected[i].coordinates) << scheme << " " << depth;
        }
        EXPECT_EQ(rebuild(set).report.kept, rebuild(set).report.details);
    }
}

std::vector<Polyline> coarseOf(const CurveSet& set) {
    std::vector<Polyline> all;
    for (const CurveLevels& curve : set.curves) all.push_back(curve.coarse);
    return all;
}

// A turn by `angle` about the origin and a shift.
Polyline moved(Polyline curve, double angle, double x, double y) {
    for (std::size_t k = 0; k < curve.coordinates.size(); k += 2) {
        const double u = curve.coordinates[k], v = curve.coordinates[k + 1];
        curve.coordinates[k] = std::cos(angle) * u - std::sin(angle) * v + x;
        curve.coordinates[k + 1] = std::sin(angle) * u + std::cos(angle) * v + y;
    }
    return curve;
}

double distance(const std::vector<Polyline>& a, const std::vector<Polyline>& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        most = std::max(most, largestDifference(a[i].coordinates, b[i].coordinates));
    return most;
}

TEST(CurveRebuild, AShiftOfTheCoarseCurveShiftsAllAndATurnDoesInLocalFrames) {
    const std::vector<Polyline> curves{wavy(300, true, 2), wavy(201, false, 2)};
    for (const char* scheme : {"dlg-refined", "cubic-7", "chaikin-4"}) {
        const CurveSet set = setOf(curves, scheme, 3);
        const auto edit = [&](double angle, double x, double y) {
            std::vector<Polyline> all = coarseOf(set);
            for (Polyline& curve : all) curve = moved(curve, angle, x, y);
            return all;
        };
        const auto expected = [&](double angle, double x, double y) {
            std::vector<Polyline> all = curves;
            for (Polyline& curve : all) curve = moved(curve, angle, x, y);
            return all;
        };
        const auto result = [&](double angle, Frames frames) {
            return rebuild(set, {.moved = edit(angle, 3, -1), .frames = frames}).curves;
        };
        EXPECT_LT(distance(result(0, Frames::global), expected(0, 3, -1)), 1e-12) << scheme;
        EXPECT_LT(distance(result(0, Frames::local), expected(0, 3, -1)), 1e-12) << scheme;
        EXPECT_LT(distance(result(1.1, Frames::local), expected(1.1, 3, -1)), 1e-12) << scheme;
        EXPECT_GT(distance(result(1.1, Frames::global), expected(1.1, 3, -1)), 1e-3) << scheme;
    }
}

// A straight comb bent to a circle: in local frames its teeth stand off the circle along its normals.
TEST(CurveRebuild, LocalFramesCarryTheTeethOfACombAroundABend) {
    Polyline comb{2, false, {}};
    const std::size_t n = 257;
    for (std::size_t i = 0; i < n; ++i) {
        comb.coordinates.push_back(static_cast<double>(i));
        comb.coordinates.push_back(i % 2 ? 1 : 0);
    }
    const CurveSet set = setOf({comb}, "dlg-trial", 1);  // its coarse curve is straight, every second point
    Polyline bent = set.curves[0].coarse;
    const double radius = 256 / M_PI;
    for (std::size_t k = 0; k < bent.coordinates.size(); k += 2) {
        const double angle = M_PI - bent.coordinates[k] / radius;
        bent.coordinates[k] = radius * std::cos(angle);
        bent.coordinates[k + 1] = radius * std::sin(angle);
    }
    const auto heights = [&](Frames frames) {
        const Polyline back = rebuild(set, {.moved = {bent}, .frames = frames}).curves[0];
        double least = INFINITY, most = -INFINITY;
        for (std::size_t i = 1; i < back.size(); i += 2) {
            const double height = std::hypot(back.coordinates[2 * i], back.coordinates[2 * i + 1]) - radius;
            least = std::min(least, height);
            most = std::max(most, height);
        }
        return std::pair(least, most);
    };
    const auto [least, most] = heights(Frames::local);
    EXPECT_GT(least, 0.99);  // of 1: the four-point rule leaves the circle a little
    EXPECT_LT(most, 1.01);
    EXPECT_LT(heights(Frames::global).first, 0.1);  // upright teeth lie flat at the sides
}

// ---- local frames in space

// A turn by `angle` about an axis that is no axis of the coordinates, and a shift.
std::array<double, 3> placed(double angle, const double* p) {
    const double u[] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    const double along = u[0] * p[0] + u[1] * p[1] + u[2] * p[2];
    std::array<double, 3> to;
    for (int c = 0; c < 3; ++c) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        const double across = u[d] * p[e] - u[e] * p[d];
        to[static_cast<std::size_t>(c)] =
            std::cos(angle) * p[c] + std::sin(angle) * across + (1 - std::cos(angle)) * along * u[c] + c - 4;
    }
    return to;
}
Polyline placed(Polyline curve, double angle) {
    for (std::size_t k = 0; k < curve.coordinates.size(); k += 3) {
        const auto to = placed(angle, &curve.coordinates[k]);
        std::copy(to.begin(), to.end(), &curve.coordinates[k]);
    }
    return curve;
}

TEST(CurveRebuild, ARigidMotionOfACoarseCurveInSpaceMovesAllInLocalFrames) {
    Polyline flat = wavy(240, true, 3);  // in a plane, which leaves no choice but to turn it over
    for (std::size_t k = 2; k < flat.coordinates.size(); k += 3) flat.coordinates[k] = 0;
    const std::vector<Polyline> curves{wavy(300, true, 3), wavy(201, false, 3), flat};
    for (const char* scheme : {"dlg-refined", "cubic-7", "chaikin-4"}) {
        const CurveSet set = setOf(curves, scheme, 3);
        for (const double angle : {0.0, 1.1, 3.0}) {
            std::vector<Polyline> edit = coarseOf(set), expected = curves;
            for (Polyline& curve : edit) curve = placed(curve, angle);
            for (Polyline& curve : expected) curve = placed(curve, angle);
            EXPECT_LT(distance(rebuild(set, {.moved = edit, .frames = Frames::local}).curves, expected),
                      1e-11)
                << scheme << ' ' << angle;
            if (angle > 0) {
                EXPECT_GT(distance(rebuild(set, {.moved = edit}).curves, expected), 1e-3) << scheme;
            }
        }
    }
}

// A straight comb in space, with teeth along z, bent in the x-y plane to a half-circle: the teeth stay upright. Bent in the x-z
// plane they stand off the circle. A shift leaves them.
TEST(CurveRebuild, LocalFramesCarryTheTeethOfACombInSpaceAroundABend) {
    Polyline comb{3, false, {}};
    const std::size_t n = 129;
    for (std::size_t i = 0; i < n; ++i)
        for (const double x : {static_cast<double>(i), 0.0, i % 2 ? 1.0 : 0.0}) comb.coordinates.push_back(x);
    const CurveSet set = setOf({comb}, "dlg-trial", 1);
    const double radius = 128 / M_PI;
    for (const std::size_t across : {1u, 2u}) {
        Polyline bent = set.curves[0].coarse;
        for (std::size_t k = 0; k < bent.coordinates.size(); k += 3) {
            const double angle = M_PI - bent.coordinates[k] / radius;
            bent.coordinates[k] = radius * std::cos(angle);
            bent.coordinates[k + across] = radius * std::sin(angle);
        }
        const Polyline back = rebuild(set, {.moved = {bent}, .frames = Frames::local}).curves[0];
        for (std::size_t i = 1; i < n; i += 2) {
            const double* const p = &back.coordinates[3 * i];
            const double off = std::hypot(p[0], p[across]) - radius, up = p[3 - across];
            EXPECT_NEAR(across == 1 ? up : off, 1, 0.02) << across << ' ' << i;
            EXPECT_NEAR(across == 1 ? off : up, 0, 0.02) << across << ' ' << i;
        }
    }
    Polyline shifted = set.curves[0].coarse;
    for (double& x : shifted.coordinates) x += 5;
    const Polyline back = rebuild(set, {.moved = {shifted}, .frames = Frames::local}).curves[0];
    for (std::size_t k = 0; k < comb.coordinates.size(); ++k)
        EXPECT_NEAR(back.coordinates[k], comb.coordinates[k] + 5, 1e-12);
}

TEST(CurveRebuild, MeasuresWhatDroppedDetailsCost) {
    const CurveSet set = setOf({wavy(512, true, 2)}, "dlg-refined", 4);
    const std::vector<Polyline> whole = rebuild(set).curves;
    double before = INFINITY;
    for (const std::size_t keep : {0, 20, 100, 300}) {
        const RebuiltCurves part = rebuild(set, {.keep = keep});
        EXPECT_EQ(part.report.kept, keep);
        double sum = 0, most = 0;
        for (std::size_t k = 0; k < 1024; k += 2) {
            const double d = std::hypot(part.curves[0].coordinates[k] - whole[0].coordinates[k],
                                        part.curves[0].coordinates[k + 1] - whole[0].coordinates[k + 1]);
            sum += d * d;
            most = std::max(most, d);
        }
        EXPECT_NEAR(part.report.error.rms, std::sqrt(sum / 512), 1e-12);
        EXPECT_NEAR(part.report.error.largest, most, 1e-12);
        EXPECT_LT(part.report.error.rms, before);
        before = part.report.error.rms;
    }
    EXPECT_EQ(rebuild(set, {.threshold = 1e9}).report.kept, 0u);
}

TEST(CurveRebuild, RefusesWhatDoesNotBelong) {
    const CurveSet set = setOf({wavy(64, true, 2), wavy(33, false, 3)}, "dlg-refined", 2);
    const auto coarse = coarseOf(set);
    EXPECT_THAT(complaint([&] { rebuild(set, {.moved = {coarse[0]}}); }),
                HasSubstr("holds 1 curves; the details are of 2"));
    auto shorter = coarse;
    shorter[0].coordinates.resize(20);
    EXPECT_THAT(
        complaint([&] { rebuild(set, {.moved = shorter}); }),
        HasSubstr(
            "curve 0 is closed, 10 points in 2D; the coarse curve of the details is closed, 16 points"));
    auto opened = coarse;
    opened[0].closed = false;
    EXPECT_THAT(complaint([&] { rebuild(set, {.moved = opened}); }), HasSubstr("curve 0 is open"));
    EXPECT_THAT(complaint([&] { rebuild(set, {.depth = 3}); }), HasSubstr("holds details for 2 levels"));
    EXPECT_FALSE(firstMovedPoint(set, coarse));
    auto other = coarse;
    other[1].coordinates[3 * 5 + 2] += 0.25;
    const auto found = firstMovedPoint(set, other);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->curve, 1u);
    EXPECT_EQ(found->point, 5u);
    EXPECT_NEAR(found->distance, 0.25, 1e-12);
}

// ---- heights ----

Grid hills(std::size_t rows, std::size_t columns, std::size_t channels = 1) {
    Grid grid{rows, columns, channels, {}};
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < columns; ++c)
            for (std::size_t k = 0; k < channels; ++k)
                grid.values.push_back(100 * std::sin(0.3 * static_cast<double>(r + k)) *
                                          std::cos(0.2 * static_cast<double>(c)) +
                                      static_cast<double>((7 * r + 13 * c) % 5));
    return grid;
}

// Through a file, as there is no other way.
ReliefDetails detailsOf(const ReliefReport& report) {
    const test::TempFolder folder;
    std::ofstream(folder / "d", std::ios::binary) << report.details;
    return ReliefDetails::load(folder / "d");
}

ReliefReport reported(const Grid& grid, const std::string& scheme, int levels,
                      ReliefLayout layout = ReliefLayout::Rows) {
    return reportRelief(grid, {.scheme = scheme, .layout = layout, .levels = levels, .details = true});
}

// NaN, where quincunx has no sample, equals NaN.
void expectSameBits(const Grid& found, const Grid& expected) {
    ASSERT_EQ(found.values.size(), expected.values.size());
    EXPECT_EQ(found.rows, expected.rows);
    for (std::size_t k = 0; k < found.values.size(); ++k)
        EXPECT_EQ(std::bit_cast<std::uint64_t>(found.values[k]),
                  std::bit_cast<std::uint64_t>(expected.values[k]));
}

TEST(ReliefRebuild, IsTheReportsReliefToTheBitAtEveryLevel) {
    for (const char* scheme : {"butterfly-trivial", "loop-like:1/16,1/8"})
        for (const Grid& grid : {hills(19, 22), hills(13, 9, 3)}) {
            const ReliefReport report = reported(grid, scheme, 2);
            const ReliefDetails details = detailsOf(report);
            EXPECT_EQ(details.coarseHeights().values, report.levels[2].heights.values);
            EXPECT_EQ(details.rebuild().heights.values, report.reconstructed.values);
            EXPECT_EQ(details.rebuild({.depth = 1}).heights.values, report.levels[1].heights.values);
            EXPECT_EQ(details.rebuild({.depth = 0}).heights.values, report.levels[2].heights.values);
            EXPECT_LT(largestDifference(details.rebuild().heights.values, grid.values), 1e-10);
        }
}

TEST(ReliefRebuild, OfQuincunxIsTheReportsReliefToTheBitAtEveryLevel) {
    for (const char* scheme : {"butterfly-3", "loop-like:1/16,1/8"})
        for (const Grid& grid : {hills(19, 35), hills(22, 40, 3)}) {
            const ReliefReport report = reported(grid, scheme, 2, ReliefLayout::Quincunx);
            const ReliefDetails details = detailsOf(report);
            expectSameBits(details.coarseHeights(), report.levels[2].heights);
            expectSameBits(details.rebuild().heights, report.reconstructed);
            expectSameBits(details.rebuild({.depth = 1}).heights, report.levels[1].heights);
            expectSameBits(details.rebuild({.depth = 0}).heights, report.levels[2].heights);
            EXPECT_EQ(details.rebuild().report.points, 3u * 8 * 9 + 1);  // a hexagon of side 8
            // Every sample of the hexagon is the grid's own again.
            const Grid again = details.rebuild().heights;
            const std::size_t row0 = (grid.rows - again.rows) / 2,
                              column0 = (grid.columns - again.columns) / 2;
            const Patch hexagon = Patch::hexagon(8);
            for (const Node node : hexagon.nodes()) {
                const std::size_t sample = quincunxSample(hexagon, node);
                for (std::size_t c = 0; c < grid.channels; ++c)
                    EXPECT_NEAR(again.values[sample * grid.channels + c],
                                grid.at(row0 + sample / again.columns, column0 + sample % again.columns, c),
                                1e-10);
            }
        }
}

TEST(ReliefRebuild, OfQuincunxFollowsTheSamplesOfTheHexagonAlone) {
    const ReliefDetails details =
        detailsOf(reported(hills(19, 35), "butterfly-trivial", 2, ReliefLayout::Quincunx));
    const Grid coarse = details.coarseHeights(), before = details.rebuild().heights;
    ReliefRebuildOptions options;
    options.edited = coarse;
    for (double& v : options.edited->values) v += 250;  // NaN stays
    const Grid raised = details.rebuild(options).heights;
    for (std::size_t k = 0; k < raised.values.size(); ++k)
        if (!std::isnan(before.values[k])) {
            EXPECT_NEAR(raised.values[k], before.values[k] + 250, 1e-9);
        }
    const Patch hexagon = Patch::hexagon(2);
    const std::size_t middle = quincunxSample(hexagon, {0, 0});
    options.edited = coarse;
    options.edited->values[middle + 1] += 7;  // between two samples
    expectSameBits(details.rebuild(options).heights, before);
    options.edited->values[middle] = std::nan("");
    EXPECT_THAT(complaint([&] { details.rebuild(options); }),
                HasSubstr("row 2, column 4 holds no finite number, but is a sample of the coarse heights"));
    Grid other = coarse;
    EXPECT_FALSE(firstMovedSample(coarse, other));
    other.values[0] = 3;  // where there is none
    EXPECT_TRUE(firstMovedSample(coarse, other));
}

TEST(ReliefRebuild, OfQuincunxMeasuresWhatDroppedDetailsCost) {
    const ReliefDetails details =
        detailsOf(reported(hills(19, 35), "butterfly-trivial", 2, ReliefLayout::Quincunx));
    const Grid whole = details.rebuild().heights;
    const RebuiltRelief part = details.rebuild({.keep = 20});
    double largest = 0;
    const Patch hexagon = Patch::hexagon(8);
    for (const Node node : hexagon.nodes()) {
        const std::size_t at = quincunxSample(hexagon, node);
        largest = std::max(largest, std::abs(part.heights.values[at] - whole.values[at]));
    }
    EXPECT_GT(largest, 0);
    EXPECT_NEAR(part.report.error.largest, largest, 1e-12);
    EXPECT_EQ(part.report.kept, 20u);
    EXPECT_EQ(part.report.details, 217u - 19);
}

// Subdivision reproduces planes: raising the coarse heights by a constant raises all, whatever is continued beyond them.
TEST(ReliefRebuild, RaisesWhatTheCoarseHeightsAreRaisedBy) {
    for (const char* scheme : {"butterfly-trivial", "loop-1"}) {
        const Grid grid = hills(19, 22);
        const ReliefDetails details = detailsOf(reported(grid, scheme, 2));
        ReliefRebuildOptions options;
        options.edited = details.coarseHeights();
        for (double& v : options.edited->values) v += 250;
        Grid expected = grid;
        for (double& v : expected.values) v += 250;
        EXPECT_LT(largestDifference(details.rebuild(options).heights.values, expected.values), 1e-9)
            << scheme;
        options.edited = details.coarseHeights();
        EXPECT_EQ(details.rebuild(options).heights.values, details.rebuild().heights.values);
    }
}

TEST(ReliefRebuild, MeasuresWhatDroppedDetailsCost) {
    const ReliefDetails details = detailsOf(reported(hills(33, 33), "butterfly-trivial", 2));
    const Grid whole = details.rebuild().heights;
    double before = INFINITY;
    for (const std::size_t keep : {0, 30, 200, 600}) {
        const RebuiltRelief part = details.rebuild({.keep = keep});
        EXPECT_EQ(part.report.kept, keep);
        EXPECT_NEAR(part.report.error.largest, largestDifference(part.heights.values, whole.values), 1e-12);
        EXPECT_LT(part.report.error.rms, before);
        before = part.report.error.rms;
    }
    EXPECT_EQ(details.rebuild().report.details, 33u * 33 - 9 * 9);
    EXPECT_EQ(details.rebuild({.threshold = 1e9}).report.kept, 0u);
}

TEST(ReliefRebuild, RefusesWhatDoesNotBelong) {
    const ReliefDetails details = detailsOf(reported(hills(17, 17), "butterfly-trivial", 2));
    ReliefRebuildOptions options;
    options.edited = hills(5, 6);
    EXPECT_THAT(
        complaint([&] { details.rebuild(options); }),
        HasSubstr("has 5 x 6 samples of 1 channels; the coarse heights of the details have 5 x 5 of 1"));
    EXPECT_THAT(complaint([&] { details.rebuild({.depth = 3}); }), HasSubstr("holds details for 2 levels"));
    Grid other = details.coarseHeights();
    EXPECT_FALSE(firstMovedSample(details.coarseHeights(), other));
    other.values[2 * 5 + 3] += 1;
    const auto found = firstMovedSample(details.coarseHeights(), other);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->row, 2u);
    EXPECT_EQ(found->column, 3u);
}

TEST(ReliefDetailsFile, RefusesDamage) {
    const std::string whole =
        reportRelief(hills(6, 5), {.scheme = "butterfly-trivial", .levels = 1, .details = true}).details;
    expectEveryDamageRefused(whole, readingHeights);
    expectOthersRefusedOrRead({kReliefDetailsMagic, 1, "", "", ""}, whole, readingHeights);
    const std::string hexagon =
        reported(hills(7, 11), "butterfly-trivial", 1, ReliefLayout::Quincunx).details;
    expectEveryDamageRefused(hexagon, readingHeights);
    expectOthersRefusedOrRead({kReliefDetailsMagic, 1, "", "", ""}, hexagon, readingHeights);
    EXPECT_THAT(readingHeights("\x93NUMPY"), HasSubstr("is no file of details of heights"));
}

}  // namespace
}  // namespace isowave::subdivision
