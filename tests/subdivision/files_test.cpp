// Curves, grids and pictures in files; reliefs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "isowave/error.h"
#include "subdivision/curves/curve_files.h"
#include "subdivision/lattice/grid_files.h"
#include "tests/subdivision/refusal.h"

namespace isowave::subdivision {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::filesystem::path fresh(const std::string& name) {
    const auto folder = std::filesystem::temp_directory_path() / "isowave_subdivision_files";
    std::filesystem::create_directories(folder);
    return folder / name;
}

// ---- curves ----

TEST(CurveText, HoldsManyCurvesOpenAndClosed) {
    const CurveFile file = CurveFile::parse(
        "# two\n>first\n0 0\n1,0\n1\t1 # corner\n0 0\n> second\n5 5 5\n6 6 6.5\n", ".txt", "t");
    ASSERT_EQ(file.curves().size(), 2u);
    EXPECT_TRUE(file.curves()[0].closed);
    EXPECT_THAT(file.curves()[0].coordinates, ElementsAre(0, 0, 1, 0, 1, 1));
    EXPECT_FALSE(file.curves()[1].closed);
    EXPECT_EQ(file.curves()[1].dimension, 3);
    EXPECT_EQ(file.with(file.curves()), ">\n0 0\n1 0\n1 1\n0 0\n>\n5 5 5\n6 6 6.5\n");
    const CurveFile again = CurveFile::parse(file.with(file.curves()), ".txt", "t");
    EXPECT_EQ(again.curves()[1].coordinates, file.curves()[1].coordinates);
}

TEST(CurveText, KeepsEveryBitOfANumber) {
    const double value = 0.1 + 0.2;
    const CurveFile file = CurveFile::parse("0 0\n0.30000000000000004 1\n", ".txt", "t");
    EXPECT_EQ(file.curves()[0].coordinates[2], value);
    EXPECT_EQ(CurveFile::parse(file.with(file.curves()), ".txt", "t").curves()[0].coordinates[2], value);
}

TEST(CurveText, AByteOrderMarkIsNoPartOfTheFirstNumber) {
    EXPECT_EQ(CurveFile::parse("\xef\xbb\xbf"
                               "1 2\r\n3 4\r\n",
                               ".txt", "t.txt")
                  .curves()[0]
                  .coordinates,
              (std::vector<double>{1, 2, 3, 4}));
}

TEST(CurveText, BadLinesAreNamed) {
    const auto tell = [](const char* text) {
        return complaint([&] { CurveFile::parse(text, ".txt", "t.txt"); });
    };
    EXPECT_THAT(tell("0 0\n1 x\n"), HasSubstr("t.txt: line 2: 'x' is not a number"));
    EXPECT_THAT(tell("0 0\n1\n"), HasSubstr("line 2: has 1 coordinate"));
    EXPECT_THAT(tell("1 2 3 4\n"), HasSubstr("more than 3"));
    EXPECT_THAT(tell("0 0\nnan 1\n"), HasSubstr("line 2: holds a number that is not finite"));
    EXPECT_THAT(tell("0 0\n1 2 3\n"), HasSubstr("with 2 and with 3 coordinates"));
    EXPECT_THAT(tell("# nothing\n"), HasSubstr("t.txt: holds no curve"));
    EXPECT_THAT(complaint([] { CurveFile::parse("", ".shp", "a.shp"); }),
                HasSubstr(".txt .xy .dat .csv .geojson .json .svg"));
    EXPECT_THAT(complaint([] { CurveFile::read("/no/such.txt"); }), HasSubstr("cannot be opened"));
}

const char* kGeoJson = R"({"type":"FeatureCollection","name":"keep me","features":[
 {"type":"Feature","properties":{"id":7},"geometry":{"type":"LineString","coordinates":[[0,0],[1,2],[3,4]]}},
 {"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,0]],[[1,1],[2,1],[2,2],[1,1]]]}},
 {"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[9,9]}},
 {"type":"Feature","properties":{},"geometry":{"type":"GeometryCollection","geometries":[
   {"type":"MultiPolygon","coordinates":[[[[0,0],[1,0],[1,1],[0,0]]]]},{"type":"MultiLineString","coordinates":[[[5,5,1],[6,6,2]]]}]}}]})";

TEST(CurveGeoJson, FindsEveryLineAndKeepsTheRest) {
    const CurveFile file = CurveFile::parse(kGeoJson, ".geojson", "g");
    ASSERT_EQ(file.curves().size(), 5u);
    EXPECT_FALSE(file.curves()[0].closed);
    EXPECT_TRUE(file.curves()[1].closed);
    EXPECT_EQ(file.curves()[1].size(), 3u);
    EXPECT_EQ(file.curves()[4].dimension, 3);
    auto points = file.curves();
    points[2].coordinates = {7, 7, 8, 8};
    const auto document = nlohmann::json::parse(file.with(points));
    EXPECT_EQ(document["name"], "keep me");
    EXPECT_EQ(document["features"][0]["properties"]["id"], 7);
    EXPECT_EQ(document["features"][1]["geometry"]["coordinates"][1].dump(),
              "[[7.0,7.0],[8.0,8.0],[7.0,7.0]]");
    EXPECT_EQ(document["features"][2]["geometry"]["coordinates"][0], 9);
}

TEST(CurveGeoJson, BadPositionsAreNamed) {
    const auto tell = [](const std::string& geometry) {
        return complaint([&] { CurveFile::parse(geometry, ".json", "g.json"); });
    };
    EXPECT_THAT(tell("{"), HasSubstr("g.json: ends in line 1 (byte 1), before its brackets are closed"));
    EXPECT_THAT(tell(R"({"type":"LineString","coordinates":[[0,0],[1,"a"]]})"),
                HasSubstr("/coordinates/1/1: is not a number"));
    EXPECT_THAT(tell(R"({"type":"LineString","coordinates":[[0,0],[1]]})"),
                HasSubstr("/coordinates/1: is not a position"));
    // Not the JSON library's own words, which name no place.
    EXPECT_THAT(tell(R"({"type":"Polygon","coordinates":{"a":1}})"),
                HasSubstr("g.json: /coordinates: is not a list of rings"));
    EXPECT_THAT(tell(R"({"type":"MultiLineString","coordinates":5})"),
                HasSubstr("g.json: /coordinates: is not a list of lines"));
    std::string deep = R"({"type":"Point"})";
    for (int k = 0; k < 1000; ++k) deep = R"({"type":"GeometryCollection","geometries":[)" + deep + "]}";
    EXPECT_THAT(tell(deep.c_str()), HasSubstr("nests collections more than 100 deep"));
    EXPECT_THAT(tell(R"({"type":"Point","coordinates":[0,0]})"), HasSubstr("holds no curve"));
}

TEST(CurveSvg, ReadsStraightPathsAndKeepsTheDrawing) {
    const std::string text =
        "<svg><!-- <path d=\"M9 9\"/> --><path id='d' style=\"fill:red\" d=\"M 0,0 h 2 v2 l-1-1.5z m5 5 L7 7 "
        "8,7\"/>"
        "<polygon points=\"0,0 1,0 1,1\"/>\n<polyline points='3 3 4 4'/><circle r=\"1\"/></svg>";
    const CurveFile file = CurveFile::parse(text, ".svg", "s");
    ASSERT_EQ(file.curves().size(), 4u);
    EXPECT_THAT(file.curves()[0].coordinates, ElementsAre(0, 0, 2, 0, 2, 2, 1, 0.5));
    EXPECT_TRUE(file.curves()[0].closed);
    EXPECT_THAT(file.curves()[1].coordinates,
                ElementsAre(5, 5, 7, 7, 8, 7));  // m after z counts from the start
    EXPECT_FALSE(file.curves()[1].closed);
    EXPECT_TRUE(file.curves()[2].closed);
    EXPECT_FALSE(file.curves()[3].closed);
    const std::string written = file.with(file.curves());
    EXPECT_THAT(written,
                HasSubstr("<path id='d' style=\"fill:red\" d=\"M0,0L2,0 2,2 1,0.5ZM5,5L7,7 8,7\"/>"));
    EXPECT_THAT(written, HasSubstr("<circle r=\"1\"/></svg>"));
    EXPECT_EQ(CurveFile::parse(written, ".svg", "s").curves()[1].coordinates, file.curves()[1].coordinates);
}

TEST(CurveSvg, CurvedPathsAreRefusedWithTheRemedy) {
    EXPECT_THAT(
        complaint([] { CurveFile::parse("<svg><path d='M0 0 C1 1 2 2 3 3'/></svg>", ".svg", "s.svg"); }),
        HasSubstr("s.svg: path 1: has the command 'C'; only straight pieces"));
    EXPECT_THAT(complaint([] { CurveFile::parse("<svg><path d='1 2'/></svg>", ".svg", "s.svg"); }),
                HasSubstr("without a command"));
    EXPECT_THAT(complaint([] { CurveFile::parse("<svg><path d='M0", ".svg", "s.svg"); }),
                HasSubstr("truncated"));
}

TEST(CurveFiles, SurviveEveryTruncation) {
    const std::string svg =
        "<svg><path d=\"M 0,0 h 2 v2 l-1-1.5z m5 5 L7 7\"/><polygon points=\"0,0 1,0 1,1\"/></svg>";
    for (const auto& [text, extension] : {std::pair(std::string(kGeoJson), ".geojson"), {svg, ".svg"}}) {
        for (std::size_t length = 0; length < text.size(); ++length) {
            // A fresh allocation each time, so that a sanitizer sees one byte too far.
            const std::string part(text.data(), length);
            try {
                CurveFile::parse(part, extension, "cut");
            } catch (const InputError&) {
            }
        }
    }
}

// ---- grids ----

std::filesystem::path file(const std::string& name, const std::string& bytes) {
    std::ofstream(fresh(name), std::ios::binary | std::ios::trunc) << bytes;
    return fresh(name);
}

TEST(Grids, OfPointsAreReadBackAndGapsAreNamed) {
    for (const std::size_t channels : {1, 3}) {
        Grid grid{3, 4, channels, {}};
        for (std::size_t k = 0; k < 12 * channels; ++k)
            grid.values.push_back(0.1 * static_cast<double>(k) - 0.5);
        const Grid again = readGrid(file("g.npy", npyBytes(grid)));
        EXPECT_EQ(again.values, grid.values);
        EXPECT_EQ(again.rows, 3u);
        EXPECT_EQ(again.channels, channels);
    }
    EXPECT_THAT(complaint([] {
                    readGrid(file("n.npy", npyBytes({2, 2, 1, {1, std::nan(""), 3, std::nan("")}})));
                }),
                HasSubstr("2 of 4 samples hold no finite number, the first at row 0, column 1"));
    EXPECT_EQ(readGrid(file("a.asc", "ncols 3\nnrows 2\n1 2 3 4 5 6.5\n")).at(1, 2), 6.5);
}

TEST(Pictures, WrittenAreReadBack) {
    Grid grid{3, 5, 1, {}};
    for (int k = 0; k < 15; ++k) grid.values.push_back(17 * k);
    const auto path = file("a.png", pngBytes(grid, 0, 255));
    const Grid again = readGrid(path);
    EXPECT_EQ(again.rows, 3u);
    EXPECT_EQ(again.columns, 5u);
    EXPECT_EQ(again.values, grid.values);
    file("a.png", pngBytes(grid, 238, 0));  // a negative: what is larger is darker
    EXPECT_EQ(readGrid(path).at(0, 0), 255);
    EXPECT_EQ(readGrid(path).at(2, 4), 0);
    std::filesystem::resize_file(path, 40);
    EXPECT_THAT(complaint([&] { readGrid(path); }), HasSubstr("a.png: this PNG ends after 40 bytes"));
    std::filesystem::create_directories(fresh("folder.png"));
    EXPECT_THAT(complaint([&] { readGrid(fresh("folder.png")); }), HasSubstr("is a folder"));
    EXPECT_THAT(complaint([&] { readGrid(fresh("none.tif")); }), HasSubstr("cannot be opened"));
    EXPECT_THAT(complaint([&] { readGrid(fresh("x.bmp")); }), HasSubstr(".npy .asc .png .tif"));
}

// A float TIFF, uncompressed, one strip, made by hand. noData: of up to three letters, for GDAL's tag.
std::string tiff(const std::vector<float>& values, unsigned columns, unsigned rows,
                 const std::string& noData = "") {
    std::string bytes("II*\0", 4);
    const auto put = [&](unsigned value, int size) {
        for (int k = 0; k < size; ++k) bytes += static_cast<char>(value >> (8 * k) & 255);
    };
    const auto data = static_cast<unsigned>(values.size() * 4);
    put(8 + data, 4);
    bytes.append(reinterpret_cast<const char*>(values.data()), data);
    const unsigned entries[][3] = {{256, 4, columns}, {257, 4, rows}, {258, 3, 32}, {259, 3, 1},
                                   {262, 3, 1},       {273, 4, 8},    {277, 3, 1},  {278, 4, rows},
                                   {279, 4, data},    {339, 3, 3}};
    put(noData.empty() ? 10 : 11, 2);
    for (const auto& [tag, type, value] : entries) {
        put(tag, 2);
        put(type, 2);
        put(1, 4);
        put(value, 4);
    }
    if (!noData.empty()) {
        put(42113, 2);
        put(2, 2);
        put(static_cast<unsigned>(noData.size()) + 1, 4);
        bytes += noData + std::string(4 - noData.size(), '\0');
    }
    put(0, 4);
    return bytes;
}

TEST(Pictures, FloatTiffIsReadAndATruncatedOneRefused) {
    const auto path = fresh("a.tif");
    const std::string whole = tiff({1.5f, -2, 3, 4, 5, 6.25f}, 3, 2);
    std::ofstream(path, std::ios::binary) << whole;
    EXPECT_THAT(readGrid(path).values, ElementsAre(1.5, -2, 3, 4, 5, 6.25));
    for (const std::size_t length : {std::size_t{0}, std::size_t{3}, std::size_t{20}, whole.size() - 30}) {
        std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
        EXPECT_THAT(complaint([&] { readGrid(path); }),
                    HasSubstr(length < 4 ? "a.tif: is no TIFF" : "a.tif: cannot be read as a picture"))
            << length;
    }
}

// As elevation models come: sea and border hold -9999 or -3.4e38, and GDAL's tag says so.
TEST(Pictures, SamplesThatATiffSaysAreNoDataAreNoHeights) {
    const auto path = fresh("n.tif");
    const auto write = [&](const std::vector<float>& values, const char* noData) {
        std::ofstream(path, std::ios::binary) << tiff(values, 3, 2, noData);
    };
    write({1.5f, -9, 3, -9, 5, 6.25f}, "-9");
    EXPECT_THAT(
        complaint([&] { readGrid(path); }),
        HasSubstr("2 of 6 samples are without data (-9), the first at row 0, column 1; fill them or crop"));
    EXPECT_EQ(readGrid(path, true).values[1], -9);
    write({1, 2, 3, 4, 5, 0.1f}, "0.1");  // no float is 0.1
    EXPECT_THAT(complaint([&] { readGrid(path); }), HasSubstr("1 of 6 samples are without data"));
    write({1, 2, 3, 4, 5, 6}, "-9");
    EXPECT_THAT(readGrid(path).values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Pictures, DeepPngKeepsItsSixteenBits) {
    // 2 x 2, 16-bit grey: 0, 1, 256, 65535.
    const unsigned char bytes[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
        0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x10, 0x00, 0x00, 0x00, 0x00, 0x07,
        0x4d, 0x8e, 0xbb, 0x00, 0x00, 0x00, 0x10, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60,
        0x60, 0x60, 0x60, 0x04, 0xc2, 0xff, 0xff, 0x01, 0x03, 0x11, 0x02, 0x01, 0xda, 0xe7, 0xa3,
        0x7f, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    const auto path = fresh("deep.png");
    std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(bytes), sizeof(bytes));
    EXPECT_THAT(readGrid(path).values, ElementsAre(0, 1, 256, 65535));
}

}  // namespace
}  // namespace isowave::subdivision
