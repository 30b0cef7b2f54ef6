// JSON and text of the other products: functions of their results alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/report/curve_levels.h"
#include "tools/report/curves.h"
#include "tools/report/hierarchy.h"
#include "tools/report/relief.h"
#include "tools/report/text.h"

namespace isowave::tools {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

std::vector<std::string> keysOf(const Json& object) {
    std::vector<std::string> keys;
    for (const auto& item : object.items()) keys.push_back(item.key());
    return keys;
}

// ---- numbers and tables ----

TEST(ReportText, NumbersAreGroupedCountedAndShort) {
    EXPECT_EQ(grouped(-1234567), "-1,234,567");
    EXPECT_EQ(counted(1, "triangle"), "1 triangle");
    EXPECT_EQ(counted(1234, "vertex", "vertices"), "1,234 vertices");
    EXPECT_EQ(shortNumber(12345.6), "12,346");
    EXPECT_EQ(shortNumber(0.123456), "0.1235");
    EXPECT_EQ(shortNumber(INFINITY), "-");
    EXPECT_EQ(bytesText(1234567), "1.23 MB");
}

TEST(ReportText, TablesAreAlignedAndEndWithoutBlanks) {
    Table table({"name", "n"});
    table.row({"a", "100"});
    table.row({"long name", ""});
    EXPECT_EQ(table.text(), "name         n\na          100\nlong name\n");
}

TEST(ReportJson, InfinityIsNull) {
    EXPECT_TRUE(finite(INFINITY).is_null());
    EXPECT_EQ(finite(2.5), 2.5);
    EXPECT_EQ(dumped(Json{{"a", 1}}, 1), "{\n \"a\": 1\n}\n");
}

// ---- curves ----

CurvesReport ladderOfTwoSteps() {
    CurvesReport report;
    report.path = "a.geojson";
    report.kind = "1 polygons of 1 rings, 4 points";
    report.pixel = 0.5;
    report.ladder.coefficients = 1100;
    report.ladder.controlPoints = 1000;
    report.ladder.fit = curves2d::Fit::distance;
    report.ladder.halfWidth = 4;
    report.ladder.band = 2;
    curves2d::StepFacts whole, half;
    whole.domain = {40, 30};
    whole.controlPoints = 1000;
    whole.rings = 1;
    whole.points = 96;
    whole.area = 1234.5;
    half.step = 1;
    report.steps = {{whole, "a_L0.svg"}, {half, std::nullopt}};
    report.files = 1;
    return report;
}

TEST(CurvesReport, JsonHasTheKeysOfTheDocumentation) {
    CurvesReport report = ladderOfTwoSteps();
    const Json j = Json::parse(jsonOf(report));
    EXPECT_THAT(keysOf(j), ElementsAre("version", "input", "fit", "steps", "hold", "coefficients_stored",
                                       "control_points", "peak_memory_bytes"));
    EXPECT_THAT(keysOf(j["fit"]),
                UnorderedElementsAre("method", "half_width", "band", "lattice_points", "disagreeing",
                                     "repair_passes", "repaired", "repair_floor", "stopped"));
    EXPECT_EQ(j["fit"]["stopped"], "agreed");
    EXPECT_EQ(j["steps"][0]["level"], 0);
    EXPECT_EQ(j["steps"][0]["file"], "a_L0.svg");
    EXPECT_TRUE(j["steps"][1]["level"].is_null());
    EXPECT_TRUE(j["steps"][1]["file"].is_null());
    EXPECT_EQ(j["steps"][0]["max_to_level0"], 0);
    EXPECT_TRUE(j["steps"][1]["max_to_level0"].is_null()) << "there is no curve to measure";
    report.smooth = true;
    report.deviation = 0.04;
    EXPECT_EQ(Json::parse(jsonOf(report))["smooth"]["deviation"], 0.02) << "pixels become the input's unit";
    report.ladder.fit = curves2d::Fit::binary;
    EXPECT_FALSE(Json::parse(jsonOf(report))["fit"].contains("band"));
}

TEST(CurvesReport, TableSummaryAndRemarks) {
    CurvesReport report = ladderOfTwoSteps();
    EXPECT_THAT(table(report), HasSubstr("L0     40x30  1,000      0      1      0      96  1,235"));
    EXPECT_THAT(table(report), HasSubstr("\nL0a "));
    EXPECT_EQ(summary(report, "out"),
              "out: 1 polygons of 1 rings, 4 points, 1,000 control points, 1,100 coefficients (+10.0 %), "
              "1 files\n");
    EXPECT_THAT(fitRemarks(report.ladder.fitReport), IsEmpty());
    report.ladder.fitReport.disagreeing = 3;
    EXPECT_THAT(fitRemarks(report.ladder.fitReport), ElementsAre(HasSubstr("3 of 0 lattice points")));
    report.deviation = 0.04;
    EXPECT_EQ(smoothRemark(report), "the smooth curves stay within 0.04 pixels of the zero set");
    report.straightPieces = 1200;
    EXPECT_THAT(smoothRemark(report), HasSubstr("; 1,200 pieces in squares that hold a sharp bend"));
}

// ---- curve-levels, relief ----

subdivision::CurveReport twoCurves() {
    subdivision::CurveReport report;
    report.scheme = "dlg-refined";
    report.levels = 2;
    report.curves.resize(2);
    for (auto& curve : report.curves) {
        curve.points = {64, 32, 16};
        curve.error = {0, 0.1, 0.2};
        curve.details = curve.detailsLeft = 48;
    }
    return report;
}

TEST(CurveLevelsReport, ComparesWithThePublishedRowWhenAsked) {
    auto report = twoCurves();
    EXPECT_THAT(textOf(report), Not(HasSubstr("published")));
    EXPECT_THAT(remarks(report), IsEmpty());
    for (auto& curve : report.curves)
        curve.compared = {{"dlg-trial", 2.0}, {"dlg-refined", 1.0}, {"dlg-optimal", 0.5}};
    EXPECT_THAT(textOf(report), HasSubstr("published: Coast (4096, 6 levels)"));
    EXPECT_THAT(textOf(report), HasSubstr("0.857")) << "the published ratio";
    EXPECT_THAT(textOf(report), HasSubstr("mean of 2 curves"));
    EXPECT_EQ(Json::parse(jsonOf(report))["curves"].size(), 2u);
    EXPECT_FALSE(Json::parse(jsonOf(report))["curves"][0].contains("threshold_l2_error"));
    report.curves[0].detailsLeft = 10;
    EXPECT_TRUE(Json::parse(jsonOf(report))["curves"][0].contains("threshold_l2_error"));
    report.tooShort = 1;
    EXPECT_THAT(remarks(report), ElementsAre(HasSubstr("1 of 2 curves are too short for 2 levels")));
    report.curves.resize(25, report.curves[0]);
    EXPECT_THAT(textOf(report), HasSubstr(".. and 5 more (--json has all)"));
}

TEST(ReliefReport, LeavesTheDetailsOfTheCoarsestLevelOut) {
    subdivision::ReliefReport report;
    report.levels.resize(2);
    report.levels[0].patch = "hexagon 48";
    report.levels[1].patch = "hexagon 24";
    report.levels[0].detailRms = 1.25;
    EXPECT_THAT(textOf(report), HasSubstr("1.25"));
    EXPECT_THAT(textOf(report), HasSubstr("hexagon 24"));
    EXPECT_EQ(Json::parse(jsonOf(report))["levels"].size(), 2u);
    EXPECT_FALSE(Json::parse(jsonOf(report)).contains("compared"));
}

// ---- hierarchies ----

TEST(HierarchyReport, SaysWhatWasTakenApart) {
    subdivision::DecompositionReport report;
    report.scheme = "loop";
    report.variant = "wide";
    report.diagonal = 2;
    report.levels.resize(2);
    report.levels[0].withoutDetails.rms = 0.01;
    EXPECT_THAT(textOf(report), HasSubstr("loop, wide; creases 0"));
    EXPECT_THAT(textOf(report), HasSubstr("base"));
    EXPECT_THAT(textOf(report), HasSubstr("0.01 (0.5 %)"));
    EXPECT_EQ(Json::parse(jsonOf(report))["levels"][0]["without_details"]["rms"], 0.01);
    EXPECT_TRUE(Json::parse(jsonOf(report)).contains("round_trip"));
}

TEST(HierarchyReport, SaysWhatLeavingDetailsOutHasCost) {
    subdivision::RebuildReport report;
    report.levels = 1;
    EXPECT_THAT(textOf(report), HasSubstr("after 1 subdivision;"));
    EXPECT_THAT(textOf(report), Not(HasSubstr("without the others")));
    EXPECT_FALSE(Json::parse(jsonOf(report)).contains("shares"));
    report.error = {0.5, 1};
    report.shares = {{0.01, 3, {0.1, 0.2}}};
    EXPECT_THAT(textOf(report), HasSubstr("without the others rms 0.5"));
    EXPECT_EQ(Json::parse(jsonOf(report))["shares"][0]["kept"], 3);
    EXPECT_EQ(textOf(SubdivisionReport{"loop", 2, 0, 10, 20}), "loop, 2 levels: 10 vertices, 20 faces\n");
    EXPECT_EQ(Json::parse(jsonOf(SubdivisionReport{"loop", 2, 0, 10, 20}))["faces"], 20);
}

}  // namespace
}  // namespace isowave::tools
