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
#include "subdivision/curves/curve_report.h"
#include "subdivision/lattice/grid_files.h"
#include "subdivision/lattice/picture_files.h"
#include "subdivision/lattice/relief.h"
#include "subdivision/lattice/relief_report.h"
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

// --- curves
// -------------------------------------------------------------------------------------------------

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
    EXPECT_THAT(tell("{"), HasSubstr("g.json: is not JSON"));
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

// --- grids
// --------------------------------------------------------------------------------------------------

std::string npy(const std::string& dictionary, const std::string& data) {
    std::string header = dictionary + "\n", bytes = "\x93NUMPY\x01";
    bytes += '\0';
    bytes += static_cast<char>(header.size() & 255);
    bytes += static_cast<char>(header.size() >> 8);
    return bytes + header + data;
}

TEST(Npy, WrittenIsReadBack) {
    for (const std::size_t channels : {1, 3}) {
        Grid grid{3, 4, channels, {}};
        for (std::size_t k = 0; k < 12 * channels; ++k)
            grid.values.push_back(0.1 * static_cast<double>(k) - 0.5);
        const Grid again = parseNpy(npyBytes(grid), "n");
        EXPECT_EQ(again.values, grid.values);
        EXPECT_EQ(again.rows, 3u);
        EXPECT_EQ(again.channels, channels);
    }
}

TEST(Npy, ReadsOtherTypesAndOrders) {
    const std::string big("\x00\x01\x00\x02\xff\xff\x01\x00", 8);
    const Grid a = parseNpy(npy("{'descr': '>i2', 'fortran_order': False, 'shape': (2, 2), }", big), "n");
    EXPECT_THAT(a.values, ElementsAre(1, 2, -1, 256));
    const Grid b = parseNpy(
        npy("{'descr': '|u1', 'fortran_order': True, 'shape': (2, 3), }", std::string("\1\2\3\4\5\6")), "n");
    EXPECT_THAT(b.values, ElementsAre(1, 3, 5, 2, 4, 6));
    const float value = 1.5f;
    std::string floats(16, '\0');
    for (int k = 0; k < 4; ++k) std::memcpy(floats.data() + 4 * k, &value, 4);
    EXPECT_EQ(
        parseNpy(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }", floats), "n").values[3],
        1.5);
}

TEST(Npy, BadFilesAreRefusedWithTheReason) {
    const auto tell = [](const std::string& bytes) { return complaint([&] { parseNpy(bytes, "n.npy"); }); };
    const std::string good = npyBytes({2, 2, 1, {1, 2, 3, 4}});
    EXPECT_THAT(tell("hello world"), HasSubstr("n.npy: is not a NumPy array"));
    EXPECT_THAT(tell(good.substr(0, good.size() - 1)),
                HasSubstr("needs 32 bytes but the file holds 31; it is truncated"));
    EXPECT_THAT(tell(npy("{'descr': '<c16', 'fortran_order': False, 'shape': (2, 2), }", "")),
                HasSubstr("type '<c16'"));
    EXPECT_THAT(tell(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }", "")),
                HasSubstr("shape (4,)"));
    EXPECT_THAT(tell(npy("{'descr': '<f8', 'fortran_order': False, }", "")), HasSubstr("no 'shape'"));
    EXPECT_THAT(
        tell(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 99999999999), }", "")),
        HasSubstr("2^20"));
    EXPECT_THAT(tell(npyBytes({2, 2, 1, {1, std::nan(""), 3, std::nan("")}})),
                HasSubstr("2 of 4 samples hold no finite number, the first at row 0, column 1"));
    for (std::size_t length = 0; length < good.size(); ++length)
        EXPECT_THROW(parseNpy(std::string(good.data(), length), "n"), InputError);
}

TEST(AsciiGrid, IsRead) {
    const Grid grid = parseAsc(
        "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 5\nNODATA_value -1\n1 2 3\n4 5 6.5\n", "a");
    EXPECT_EQ(grid.rows, 2u);
    EXPECT_THAT(grid.values, ElementsAre(1, 2, 3, 4, 5, 6.5));
}

TEST(AsciiGrid, BadFilesAreRefusedWithTheReason) {
    const auto tell = [](const char* text) { return complaint([&] { parseAsc(text, "a.asc"); }); };
    EXPECT_THAT(tell("1 2 3"), HasSubstr("no 'ncols'"));
    EXPECT_THAT(tell("ncols 3\nnrows 2\n1 2 3 4"), HasSubstr("say 6 samples but 4 can be read"));
    EXPECT_THAT(tell("ncols 3\nnrows x\n"), HasSubstr("'nrows' has no number"));
    EXPECT_THAT(tell("ncols -3\nnrows 2\n"), HasSubstr("from 2 to 2^20"));
    EXPECT_THAT(tell("ncols 2\nnrows 2\n1 2 -9999 -9999"),
                HasSubstr("2 of 4 samples are without data, the first at row 1, column 0"));
}

TEST(Pictures, WrittenAreReadBack) {
    Grid grid{3, 5, 1, {}};
    for (int k = 0; k < 15; ++k) grid.values.push_back(17 * k);
    const auto path = fresh("a.png");
    writePng(path, grid, 0, 255);
    const Grid again = readPictureOrGrid(path);
    EXPECT_EQ(again.rows, 3u);
    EXPECT_EQ(again.columns, 5u);
    EXPECT_EQ(again.values, grid.values);
    writePng(path, grid, 238, 0);  // a negative: what is larger is darker
    EXPECT_EQ(readPictureOrGrid(path).at(0, 0), 255);
    EXPECT_EQ(readPictureOrGrid(path).at(2, 4), 0);
    std::filesystem::resize_file(path, 40);
    EXPECT_THAT(complaint([&] { readPictureOrGrid(path); }), HasSubstr("a.png: cannot be read as a picture"));
    EXPECT_THAT(complaint([&] { readPictureOrGrid(fresh("none.tif")); }), HasSubstr("cannot be opened"));
    EXPECT_THAT(complaint([&] { readPictureOrGrid(fresh("x.bmp")); }), HasSubstr(".npy .asc .png .tif"));
    EXPECT_THROW(writePng("/no/folder/a.png", grid, 0, 255), OperationError);
}

// A float TIFF, uncompressed, one strip, made by hand.
std::string tiff(const std::vector<float>& values, unsigned columns, unsigned rows) {
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
    put(10, 2);
    for (const auto& [tag, type, value] : entries) {
        put(tag, 2);
        put(type, 2);
        put(1, 4);
        put(value, 4);
    }
    put(0, 4);
    return bytes;
}

TEST(Pictures, FloatTiffIsReadAndATruncatedOneRefused) {
    const auto path = fresh("a.tif");
    const std::string whole = tiff({1.5f, -2, 3, 4, 5, 6.25f}, 3, 2);
    std::ofstream(path, std::ios::binary) << whole;
    EXPECT_THAT(readPictureOrGrid(path).values, ElementsAre(1.5, -2, 3, 4, 5, 6.25));
    for (const std::size_t length : {std::size_t{0}, std::size_t{3}, std::size_t{20}, whole.size() - 30}) {
        std::ofstream(path, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
        EXPECT_THAT(complaint([&] { readPictureOrGrid(path); }),
                    HasSubstr("a.tif: cannot be read as a picture"))
            << length;
    }
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
    EXPECT_THAT(readPictureOrGrid(path).values, ElementsAre(0, 1, 256, 65535));
}

// --- reports
// ------------------------------------------------------------------------------------------------

TEST(CurveReport, OfTwoCurvesWritesEveryLevelAndSaysWhichIsTooShort) {
    std::string lines = ">\n";
    for (int k = 0; k <= 64; ++k)
        lines += std::to_string(std::cos(M_PI * k / 32)) + " " +
                 std::to_string(std::sin(M_PI * k / 32) + (k % 64 == 5)) + "\n";
    lines += ">\n0 0\n1 0\n1 1\n0 0\n";
    const CurveFile file = CurveFile::parse(lines, ".txt", "t");
    const CurveReport report = reportCurves(file, ".txt", {.levels = 3, .threshold = 0.01, .compare = true});
    ASSERT_EQ(report.curves.size(), 2u);
    EXPECT_THAT(report.curves[0].points, ElementsAre(64, 32, 16, 8));
    EXPECT_THAT(report.curves[1].points, ElementsAre(3, 2, 1));
    EXPECT_THAT(report.remarks, ElementsAre(HasSubstr("1 of 2 curves are too short for 3 levels")));
    EXPECT_LT(report.curves[0].error[0], 1e-12);
    EXPECT_LT(report.curves[0].error[1], report.curves[0].error[3]);
    EXPECT_LT(report.curves[0].detailsLeft, report.curves[0].details);
    EXPECT_GT(report.curves[0].thresholdError, 0);
    EXPECT_LT(report.curves[0].compared.at("dlg-refined"), report.curves[0].compared.at("dlg-trial"));
    EXPECT_EQ(report.files.size(), 6u);
    EXPECT_EQ(CurveFile::parse(report.files.at("level_2.txt"), ".txt", "l").curves()[0].size(), 16u);
    EXPECT_EQ(CurveFile::parse(report.files.at("smooth.txt"), ".txt", "l").curves()[0].size(), 64u);
    EXPECT_THAT(text(report), HasSubstr("0.857"));
    EXPECT_EQ(nlohmann::json::parse(json(report))["curves"].size(), 2u);
    EXPECT_THAT(complaint([&] { reportCurves(file, ".txt", {.levels = 9}); }),
                HasSubstr("need at least 257"));
    EXPECT_THAT(complaint([&] { reportCurves(file, ".txt", {.scheme = "x"}); }), HasSubstr("dlg-refined"));
    const CurveReport kept =
        reportCurves(file, ".txt", {.scheme = "cubic", .levels = 2, .resample = 50, .keep = 10});
    EXPECT_THAT(kept.curves[1].points, ElementsAre(50, 25, 13));
    EXPECT_EQ(kept.curves[0].detailsLeft, 10u);
    EXPECT_EQ(reportCurves(file, ".txt", {.mask = "1/4 3/4 3/4 1/4", .levels = 1}).scheme, "mask-4");
}

TEST(ReliefReport, HoldsPicturesAndNumbersOfEveryLevel) {
    const Grid grid = readGrid(ISOWAVE_TEST_DATA "/terrain/jacksboro.npy");
    const ReliefReport report =
        reportRelief(grid, {.scheme = "butterfly-3", .layout = ReliefLayout::Quincunx, .levels = 2});
    ASSERT_EQ(report.levels.size(), 3u);
    EXPECT_EQ(report.levels[0].patch, "hexagon 48");
    EXPECT_LT(report.roundTrip, 1e-12 * 1040);
    EXPECT_LT(report.levels[0].suppressedRms, report.levels[1].suppressedRms);
    EXPECT_LT(report.levels[1].suppressedRms, report.levels[2].suppressedRms);
    for (const char* name :
         {"level_0.npy", "level_2.png", "shade_1.png", "details_0.png", "details_1.png", "suppressed.npy",
          "suppressed.png", "suppressed_shade.png", "reconstructed.npy"}) {
        EXPECT_TRUE(report.files.contains(name)) << name;
    }
    EXPECT_FALSE(report.files.contains("details_2.png"));
    std::ofstream(fresh("details.png"), std::ios::binary) << report.files.at("details_0.png");
    const Grid details = readPictureOrGrid(fresh("details.png"));
    EXPECT_EQ(*std::max_element(details.values.begin(), details.values.end()),
              255);  // vertex nodes hold no detail
    EXPECT_EQ(*std::min_element(details.values.begin(), details.values.end()), 0);
    EXPECT_THAT(text(report), HasSubstr("hexagon 12"));
    EXPECT_EQ(nlohmann::json::parse(json(report))["levels"].size(), 3u);
}

// --- reliefs
// ------------------------------------------------------------------------------------------------

double rms(const std::vector<double>& values) {
    double sum = 0;
    for (const double v : values) sum += v * v;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(Relief, LayoutsTakeTheMiddle) {
    Grid grid{11, 24, 1, {}};
    for (std::size_t r = 0; r < 11; ++r) {
        for (std::size_t c = 0; c < 24; ++c) grid.values.push_back(static_cast<double>(100 * r + c));
    }
    const SurfaceField rows = reliefField(grid, ReliefLayout::Rows, 2);
    EXPECT_EQ(rows.patch, Patch::parallelogram(20, 8));
    EXPECT_EQ(rows.values[0], 101);  // row 1, column 1
    EXPECT_EQ(reliefPicture(rows, ReliefLayout::Rows).at(3, 5), 406);
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
        const SurfaceLevels made = decompose(field, filters, levels);
        const auto without = subdivided(made, filters, levels).values;
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

}  // namespace
}  // namespace isowave::subdivision
