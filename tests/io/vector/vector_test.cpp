// Lines in files: the promises of io/vector's headers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "io/vector/geojson.h"
#include "io/vector/point_text.h"
#include "io/vector/svg.h"
#include "isowave/error.h"

namespace isowave {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = PointRow::Kind;

template <class F>
std::string complaint(const F& f) {
    try {
        f();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        return error.what();
    }
    return "";
}

std::vector<PointRow> rowsOf(std::string_view text) {
    std::vector<PointRow> rows;
    eachPointRow(text, [&](const PointRow& row) { rows.push_back(row); });
    return rows;
}

// ---- text

TEST(PointText, RowsSayWhatTheyAre) {
    const auto rows = rowsOf(
        "\xef\xbb\xbf"
        "# two\r\n> a\r\n1 2\r\n\r\n +3,\t-4e1 , 5 # there\n6 7 8 9 10\n1 x 2\n \t\nlast 1");
    ASSERT_EQ(rows.size(), 9u);
    EXPECT_EQ(rows[0].kind, Kind::comment);
    EXPECT_EQ(rows[1].kind, Kind::separator);
    EXPECT_EQ(rows[2].text, "1 2");
    EXPECT_EQ(rows[3].kind, Kind::blank);
    EXPECT_EQ(rows[4].columns, 3);
    EXPECT_THAT(rows[4].values, ElementsAre(3, -40, 5, 0));
    EXPECT_EQ(rows[5].columns, 4);
    EXPECT_EQ(rows[6].columns, 1);
    EXPECT_EQ(rows[6].noNumber, "x 2");
    EXPECT_EQ(rows[7].kind, Kind::blank);
    EXPECT_EQ(rows[8].number, 9u);
    EXPECT_EQ(rows[8].noNumber, "last 1");
}

TEST(PointText, NumbersBeyondTheRangeAreInfiniteOrZero) {
    EXPECT_THAT(rowsOf("1e999 -1e999 1e-999 0.1")[0].values, ElementsAre(HUGE_VAL, -HUGE_VAL, 0, 0.1));
    EXPECT_TRUE(std::isnan(rowsOf("nan")[0].values[0]));
    EXPECT_EQ(rowsOf("+-1")[0].columns, 0);
    EXPECT_EQ(rowsOf("1_0")[0].columns, 0);
}

TEST(PointText, WrittenIsReadBackToTheLastBit) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> at(-1, 1);
    Polyline line{3, false, {}};
    for (int k = 0; k < 300; ++k) line.coordinates.push_back(std::ldexp(at(random), k % 100 - 50));
    std::vector<double> back;
    for (const PointRow& row : rowsOf(pointText({line})))
        back.insert(back.end(), row.values, row.values + row.columns);
    EXPECT_EQ(back, line.coordinates);
    EXPECT_EQ(pointText({{2, true, {0, 0, 1, 0, 1, 1}}, {2, false, {5, 6}}}),
              ">\n0 0\n1 0\n1 1\n0 0\n>\n5 6\n");
}

// ---- GeoJSON

GeoJson plane(const std::string& text) { return {text, GeoJson::Positions::plane, "g"}; }
GeoJson space(const std::string& text) { return {text, GeoJson::Positions::space, "g"}; }

const std::string kDocument = R"({"type":"FeatureCollection","name":"keep","features":[
 {"type":"Feature","properties":{"id":7},"geometry":{"type":"LineString","coordinates":[[0,0,1],[1,2,3]]}},
 {"type":"Feature","geometry":null},
 {"type":"Feature","geometry":{"type":"MultiPolygon","coordinates":[[[[0,0],[4,0],[4,4],[0,0]],[[1,1],[2,1],[2,2],[1,1]]],[[[8,8],[9,8],[9,9],[8,8]]]]}},
 {"type":"Feature","geometry":{"type":"GeometryCollection","geometries":[{"type":"Point","coordinates":[9,9]},
   {"type":"MultiLineString","coordinates":[[[5,5],[6,6]],[]]}]}}]})";

TEST(GeoJson, GeometriesComeInTheirOrderWithTheirPlaces) {
    const GeoJson file = space(kDocument);
    const auto& geometries = file.geometries();
    ASSERT_EQ(geometries.size(), 5u);
    EXPECT_EQ(geometries[0].type, "LineString");
    EXPECT_EQ(geometries[0].lines[0].points.dimension, 3);
    EXPECT_THAT(geometries[0].lines[0].points.coordinates, ElementsAre(0, 0, 1, 1, 2, 3));
    EXPECT_FALSE(geometries[0].lines[0].points.closed);
    EXPECT_EQ(geometries[1].lines.size(), 2u);
    EXPECT_TRUE(geometries[1].lines[1].points.closed);
    EXPECT_EQ(geometries[1].lines[1].pointer, "/features/2/geometry/coordinates/0/1");
    EXPECT_EQ(geometries[2].lines[0].points.size(), 4u);  // with its last point
    EXPECT_EQ(geometries[3].type, "Point");
    EXPECT_THAT(geometries[3].lines, IsEmpty());
    EXPECT_EQ(geometries[4].lines.size(), 2u);
    EXPECT_EQ(plane(kDocument).geometries()[0].lines[0].points.dimension, 2);
}

TEST(GeoJson, OtherPointsLeaveTheRestOfTheDocument) {
    const GeoJson file = space(kDocument);
    const std::string text = file.with({"/features/2/geometry/coordinates/0/1"}, {{2, true, {7, 7, 8, 8}}});
    EXPECT_THAT(text, HasSubstr("[[7.0,7.0],[8.0,8.0],[7.0,7.0]]"));
    EXPECT_THAT(text, HasSubstr(R"("name":"keep")"));
    EXPECT_THAT(text, HasSubstr(R"({"type":"Point","coordinates":[9,9]})"));
    EXPECT_EQ(space(text).geometries()[2].lines[0].points.coordinates,
              file.geometries()[2].lines[0].points.coordinates);
}

TEST(GeoJson, WhatCannotBeReadIsToldWithItsPlace) {
    const auto fault = [](const GeoJson& file) {
        const GeoGeometry& geometry = file.geometries().at(0);
        return geometry.fault ? *geometry.fault : *geometry.lines.back().fault;
    };
    using Fault = GeoFault::Kind;
    const auto line = [](const std::string& list) {
        return R"({"type":"LineString","coordinates":)" + list + "}";
    };
    EXPECT_EQ(fault(space(line("[[0,0],[1]]"))).kind, Fault::notAPosition);
    EXPECT_EQ(fault(space(line("[[0,0],[1]]"))).pointer, "/coordinates/1");
    EXPECT_EQ(fault(space(line("[[0,0],[1,2,3,4]]"))).kind, Fault::notAPosition);
    EXPECT_FALSE(plane(line("[[0,0],[1,2,3,4]]")).geometries()[0].lines[0].fault);
    EXPECT_EQ(fault(space(line("[[0,0],[1,\"a\"]]"))).pointer, "/coordinates/1/1");
    EXPECT_EQ(fault(plane(line("[[0,0],[1,\"a\"]]"))).found, "[1,\"a\"]");
    EXPECT_EQ(fault(space(line("[[0,0],[1,2,3]]"))).kind, Fault::otherDimension);
    EXPECT_EQ(fault(space(line("5"))).kind, Fault::notAList);
    EXPECT_EQ(fault(space(R"({"type":"Polygon","coordinates":[7]})")).pointer, "/coordinates/0");
    EXPECT_EQ(fault(space(R"({"type":"MultiPolygon","coordinates":[7]})")).kind, Fault::notAList);
    EXPECT_EQ(fault(space(R"({"type":"FeatureCollection"})")).found, "features");
    EXPECT_TRUE(space("{").complaint());
    EXPECT_FALSE(space("[]").type());
    std::string deep = R"({"type":"Point"})";
    for (int k = 0; k < 1000; ++k) deep = R"({"type":"GeometryCollection","geometries":[)" + deep + "]}";
    EXPECT_THAT(complaint([&] { space(deep); }), HasSubstr("nests collections more than 100 deep"));
}

const std::string kTopology = R"({"type":"Topology","transform":{"scale":[0.5,2],"translate":[10,20]},
 "arcs":[[[0,0],[4,0],[0,4]],[[0,0],[0,4],[4,0]]],
 "objects":{"z":{"type":"Polygon","arcs":[[0]]},"land":{"type":"Polygon","arcs":[[0,-2]]}}})";

TEST(TopoJson, ArcsAreStitchedForwardsAndBackwardsInTheOrderOfNames) {
    const GeoJson file = plane(kTopology);
    ASSERT_EQ(file.geometries().size(), 2u);
    EXPECT_EQ(file.geometries()[0].pointer, "/objects/land");
    EXPECT_THAT(file.geometries()[0].lines[0].points.coordinates,
                ElementsAre(10, 20, 12, 20, 12, 28, 12, 28, 10, 28, 10, 20));
    EXPECT_THAT(space(kTopology).geometries(), IsEmpty());
    for (const char* number : {"2", "-3", "18446744073709551615", "1.5", "null"}) {
        std::string text = kTopology;
        text.replace(text.find("[0,-2]"), 6, std::string("[") + number + "]");
        const GeoJson other = plane(text);
        ASSERT_TRUE(other.geometries()[0].lines[0].fault) << number;
        EXPECT_EQ(other.geometries()[0].lines[0].fault->found, std::string("arc ") + number + " of 2");
    }
}

TEST(GeoJson, EveryCutIsToldAndNoDamageCrashes) {
    std::mt19937 random(5);
    for (const std::string& text : {kDocument, kTopology})
        for (std::size_t n = 0; n < text.size(); ++n) {
            const std::string part(text.data(), n);
            EXPECT_TRUE(plane(part).complaint());
            std::string damaged = text;
            damaged[n] = static_cast<char>(random() % 96 + 32);
            complaint([&] { plane(damaged); });
            complaint([&] { space(damaged); });
        }
}

// ---- SVG

const std::string kDrawing =
    "<svg><!-- <path d=\"M9 9\"/> --><path id='d' style=\"fill:red\" d=\"M 0,0 h 2 v2 l-1-1.5z m5 5 L7 7 "
    "8,7\"/>"
    "<polygon points=\"0,0 1,0 1,1\"/>\n<polyline points='3 3 4 4'/><circle r=\"1\"/></svg>";

TEST(Svg, StraightPathsAreReadAndTheDrawingIsKept) {
    const SvgLines file(kDrawing, "s");
    ASSERT_EQ(file.lines().size(), 4u);
    EXPECT_THAT(file.lines()[0].coordinates, ElementsAre(0, 0, 2, 0, 2, 2, 1, 0.5));
    EXPECT_TRUE(file.lines()[0].closed);
    EXPECT_THAT(file.lines()[1].coordinates,
                ElementsAre(5, 5, 7, 7, 8, 7));  // m after z counts from the start
    EXPECT_TRUE(file.lines()[2].closed);
    EXPECT_FALSE(file.lines()[3].closed);
    const std::string written = file.with(file.lines());
    EXPECT_THAT(written,
                HasSubstr("<path id='d' style=\"fill:red\" d=\"M0,0L2,0 2,2 1,0.5ZM5,5L7,7 8,7\"/>"));
    EXPECT_THAT(written, HasSubstr("<circle r=\"1\"/></svg>"));
    EXPECT_EQ(SvgLines(written, "s").lines()[1].coordinates, file.lines()[1].coordinates);
}

TEST(Svg, WhatIsNotStraightOrNoNumberIsRefusedWithItsElement) {
    const auto tell = [](const char* text) { return complaint([&] { SvgLines(text, "s.svg"); }); };
    EXPECT_THAT(tell("<svg><path d='M0 0 C1 1 2 2 3 3'/></svg>"),
                HasSubstr("s.svg: path 1: has the command 'C'; only straight pieces"));
    EXPECT_THAT(tell("<svg><path d='1 2'/></svg>"), HasSubstr("without a command"));
    EXPECT_THAT(tell("<svg><path d='M0"), HasSubstr("truncated"));
    EXPECT_THAT(tell("<svg><path d='M0 1e999'/></svg>"), HasSubstr("has no number at '1e999'"));
    EXPECT_THAT(tell("<svg><polygon points='0 0 1'/></svg>"), HasSubstr("polygon 1: has no number at ''"));
    EXPECT_THAT(tell("<svg><polyline points='0 0 a'/></svg>"), HasSubstr("has 'a' among its points"));
}

TEST(Svg, ATagInsideATagIsNoOtherOne) {
    const std::string text = "<svg><polygon p<polyline points=\"0 0 1 0 1 1\"/></svg>";
    const SvgLines svg(text, "a.svg");
    ASSERT_EQ(svg.lines().size(), 1u);
    EXPECT_TRUE(svg.lines()[0].closed);
    EXPECT_EQ(SvgLines(svg.with(svg.lines()), "again").lines().size(), 1u);
}

TEST(Svg, RelativePiecesThatOverflowAreRefused) {
    EXPECT_THAT(complaint([] { SvgLines("<path d=\"m 1e308 0 l 1e308 0\"/>", "a.svg"); }),
                HasSubstr("a.svg: path 1: has relative pieces that add up to no finite number"));
}

TEST(Svg, NoCutOrDamageCrashes) {
    std::mt19937 random(6);
    for (std::size_t n = 0; n < kDrawing.size(); ++n) {
        complaint([&] { SvgLines(std::string(kDrawing.data(), n), "s"); });
        std::string damaged = kDrawing;
        damaged[n] = static_cast<char>(random() % 96 + 32);
        complaint([&] { SvgLines(damaged, "s"); });
    }
}

}  // namespace
}  // namespace isowave
