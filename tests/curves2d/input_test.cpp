// Rasterising, reading images and polygons, writing curves: the promises of raster.h, bitmap_shape.h,
// polygon_input.h, draw.h and ladder.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <sstream>

#include "curves2d/bitmap_shape.h"
#include "curves2d/draw.h"
#include "curves2d/ladder.h"
#include "curves2d/polygon_input.h"
#include "curves2d/raster.h"
#include "curves2d/shapes.h"
#include "curves2d/validity.h"
#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

const fs::path kData = ISOWAVE_TEST_DATA "/curves2d";

class Files : public testing::Test {
  protected:
    Files() : folder_(fs::temp_directory_path() / ("isowave_curves_" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
    }
    ~Files() override { fs::remove_all(folder_); }
    fs::path file(const std::string& name, const std::string& content) const {
        std::ofstream(folder_ / name, std::ios::binary) << content;
        return folder_ / name;
    }
    static std::string read(const fs::path& path) {
        std::ifstream stream(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    fs::path folder_;
};

template <class F>
std::string errorOf(const F& f) {
    try {
        f();
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        return error.what();
    }
    return "nothing was thrown";
}

// ---- raster ----

// Even-odd by the definition: crossings to the left of the point.
bool insideByDefinition(const Polygon& polygon, double x, double y) {
    bool in = false;
    for (const Ring& ring : polygon.rings)
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Point a = ring[i], b = ring[(i + 1) % ring.size()];
            if ((a.y <= y) != (b.y <= y) && a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y) <= x) in = !in;
        }
    return in;
}

TEST(Raster, AgreesWithTheDefinitionAtEveryLatticePoint) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> at(-20, 20);
    for (int n = 0; n < 50; ++n) {
        Polygon polygon;
        for (int r = 0; r < 3; ++r) {
            Ring ring;
            for (int i = 0; i < 3 + n % 9; ++i) ring.push_back({at(random), at(random)});
            polygon.rings.push_back(ring);
        }
        const Region region = rasterise({polygon}, Frame{});
        for (int y = -25; y <= 25; ++y)
            for (int x = -25; x <= 25; ++x)
                ASSERT_EQ(region.contains(x, y), insideByDefinition(polygon, x, y))
                    << n << " " << x << " " << y;
    }
}

TEST(Raster, PolygonsThatShareAnEdgeLeaveNoSlitAndDoNotOverlap) {
    // A fan around a lattice point, corners on and off the lattice: the pieces tile the whole.
    std::mt19937 random(8);
    std::uniform_real_distribution<double> radius(5, 15);
    Ring hull;
    const Point middle{20, 20};
    for (int i = 0; i < 16; ++i)
        hull.push_back(middle +
                       radius(random) * Point{std::cos(i * 0.3926990817), std::sin(i * 0.3926990817)});
    std::int64_t sum = 0;
    std::vector<Polygon> fan;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        fan.push_back({{{middle, hull[i], hull[(i + 1) % hull.size()]}}});
        sum += rasterise({fan.back()}, Frame{}).pointCount();
    }
    const std::int64_t whole = rasterise({{{hull}}}, Frame{}).pointCount();
    EXPECT_EQ(sum, whole);
    EXPECT_EQ(rasterise(fan, Frame{}).pointCount(), whole);
    EXPECT_EQ(boundary(fan, Frame{}).size(), hull.size());  // spokes are borders between two insides
}

TEST(Raster, LongerSideHasTheWantedNumberOfPixels) {
    const std::vector<Polygon> box = {{{{{10, 50}, {14, 50}, {14, 52}, {10, 52}}}}};
    const Frame frame = frameAround(box, 40);
    EXPECT_DOUBLE_EQ(frame.spacing.x, 0.1);
    const Region region = rasterise(box, frame);
    EXPECT_EQ(region.pointCount(), 40 * 20);
    EXPECT_EQ(region.row(0), (Spans{{0, 39}}));
    EXPECT_THAT(errorOf([] {
                    frameAround({{{{{1, 1}, {1, 1}, {1, 1}}}}}, 10);
                }),
                HasSubstr("no ring has an extent"));
}

TEST(Raster, RefusesPointsTooFarAway) {
    EXPECT_THAT(errorOf([] {
                    rasterise({{{{{0, 0}, {1e12, 0}, {0, 1}}}}}, Frame{});
                }),
                HasSubstr("2^28 pixels"));
}

// ---- images ----

using Images = Files;

TEST_F(Images, PgmAndPbmInTextAndBytesSayTheSame) {
    const std::vector<float> grey = {0, 7, 255, 12, 13, 14}, bits = {0, 255, 0, 255, 255, 0};
    EXPECT_EQ(readBitmap(file("a.pgm", "P2 # text\n3 2\n255\n0 7 255\n12 13 14\n")).values, grey);
    EXPECT_EQ(readBitmap(file("b.pgm", std::string("P5\n3 2\n255\n\0\7\xff\14\15\16", 17))).values, grey);
    EXPECT_EQ(readBitmap(file("c.pbm", "P1\n3 2\n101\n0 0 1")).values, bits);
    EXPECT_EQ(readBitmap(file("d.pbm", "P4\n3 2\n\xa0\x20")).values, bits);
    EXPECT_EQ(readBitmap(file("e.pgm", std::string("P5 1 1 65535\n\1\2", 15))).values,
              std::vector<float>{258});
}

TEST_F(Images, EveryTruncationIsRefused) {
    const std::string whole = std::string("P5\n3 2\n255\n\0\7\xff\14\15\16", 17);
    for (std::size_t n = 0; n < whole.size(); ++n)
        EXPECT_THROW(readBitmap(file("cut.pgm", whole.substr(0, n))), InputError) << n;
    // 2 x 2 pixels of 24 bits, rows of 8 bytes.
    std::string bmp("BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\2\0\0\0\2\0\0\0\1\0\x18\0", 30);
    bmp += std::string(24, '\0') + std::string("\xff\xff\xff\0\0\0\0\0\0\0\0\xff\xff\xff\0\0", 16);
    EXPECT_EQ(readBitmap(file("a.bmp", bmp)).values, (std::vector<float>{0, 255, 255, 0}));
    for (std::size_t n = 2; n < bmp.size(); ++n)
        EXPECT_THROW(readBitmap(file("cut.bmp", bmp.substr(0, n))), InputError) << n;
    const std::string png = read(kData / "keyring.png");
    for (std::size_t n = 0; n + 200 < png.size(); n += png.size() / 40)
        EXPECT_THROW(readBitmap(file("cut.png", png.substr(0, n))), InputError) << n;
    for (std::size_t n = 8; n < png.size(); n += png.size() / 40) {
        std::string damaged = png;
        damaged[n] = static_cast<char>(damaged[n] ^ 1);
        EXPECT_THROW(readBitmap(file("damaged.png", damaged)), InputError) << n;
    }
}

TEST_F(Images, PngOnTransparentGroundIsReadAsItsOpacity) {
    const Bitmap keys = readBitmap(kData / "keyring.png");
    EXPECT_EQ(keys.width, 200);
    EXPECT_EQ(keys.height, 150);
    EXPECT_TRUE(keys.isOpacity);
    EXPECT_EQ(keys.at(0, 0), 0);  // the ground
    const ValueRange range = valueRange(keys);
    EXPECT_GT(range.high, 250);
    EXPECT_FALSE(range.twoValues);
}

// A square of 4 x 4 in 10 x 10, as dark on light and as light on dark: 16 pixels, whichever way, and the rest with invert.
TEST(Ground, IsWhatTouchesTheBorder) {
    for (const bool dark : {false, true}) {
        std::vector<float> values(100, dark ? 255 : 0);
        for (int y = 3; y < 7; ++y)
            for (int x = 3; x < 7; ++x) values[static_cast<std::size_t>(10 * y + x)] = dark ? 0 : 255;
        for (const bool invert : {false, true}) {
            const Input input = pictureInput(10, 10, values, {.invert = invert});
            std::int64_t inside = 0;
            for (const Spans& row : input.shape->inside.rows)
                for (const Span& span : row) inside += span.last - span.first + 1;
            EXPECT_EQ(inside, invert ? 84 : 16) << dark;
            EXPECT_THAT(input.remarks, testing::Contains(HasSubstr(dark != invert ? "is dark" : "is light")));
        }
        values[0] = dark ? 0 : 255;  // a border of both: light is inside, as the values say
        EXPECT_THAT(pictureInput(10, 10, values, {}).remarks, testing::Contains(HasSubstr("is light")));
    }
}

TEST_F(Images, BadOnesAreRefusedInOneLine) {
    EXPECT_THAT(errorOf([&] { readBitmap(folder_ / "none.png"); }), HasSubstr("cannot be read"));
    EXPECT_THAT(errorOf([&] { readInput(folder_ / "none.png", {}); }), HasSubstr("there is no such file"));
    EXPECT_THAT(errorOf([&] { readBitmap(file("empty.png", "")); }), HasSubstr("is empty"));
    EXPECT_THAT(errorOf([&] { readBitmap(file("text.png", "hello, I am a picture")); }),
                HasSubstr("neither PNG"));
    EXPECT_THAT(errorOf([&] { readBitmap(file("zero.pgm", "P5\n0 3\n255\n")); }), HasSubstr("0 x 3 pixels"));
    EXPECT_THAT(errorOf([&] { readBitmap(file("huge.pgm", "P5\n999999 999999\n255\n")); }),
                HasSubstr("2^31"));
    EXPECT_THAT(errorOf([&] { readInput(file("flat.pgm", "P2 2 2 255 9 9 9 9"), {}); }),
                HasSubstr("every pixel is 9"));
    EXPECT_THAT(errorOf([&] { readBitmap(file("above.pgm", "P2 2 1 255 9 900")); }),
                HasSubstr("pixel 1 is 900; its header says that 255 is the largest value"));
    EXPECT_THAT(errorOf([&] { readInput(file("low.pgm", "P2 2 2 255 9 8 9 9"), {.iso = 100}); }),
                HasSubstr("values run from 8 to 9"));
    EXPECT_THAT(errorOf([&] { readInput(folder_, {}); }), HasSubstr("cannot be read"));
}

// A 2x2 TIFF of floats, one of which is not a number.
TEST_F(Images, NotANumberIsRefusedWithItsPlace) {
    std::string tiff("II*\0\x18\0\0\0", 8);
    for (const float v : {1.0f, 2.0f, NAN, 4.0f}) tiff.append(reinterpret_cast<const char*>(&v), 4);
    const auto tag = [&](std::uint16_t id, std::uint16_t type, std::uint32_t value) {
        const std::uint32_t count = 1;
        tiff.append(reinterpret_cast<const char*>(&id), 2).append(reinterpret_cast<const char*>(&type), 2);
        tiff.append(reinterpret_cast<const char*>(&count), 4)
            .append(reinterpret_cast<const char*>(&value), 4);
    };
    tiff.append("\x0a\0", 2);
    tag(256, 3, 2), tag(257, 3, 2), tag(258, 3, 32), tag(259, 3, 1), tag(262, 3, 1), tag(273, 4, 8);
    tag(277, 3, 1), tag(278, 3, 2), tag(279, 4, 16), tag(339, 3, 3);
    tiff.append(4, '\0');
    EXPECT_THAT(errorOf([&] { readBitmap(file("nan.tif", tiff)); }),
                HasSubstr("pixel (0, 1) is nan; 1 of 4"));
}

TEST_F(Images, IsoLineOfAGreyImageLiesBetweenThePixels) {
    // A ramp: 0 40 80 120; iso 100 lies at x = 2.5.
    const Bitmap ramp = readBitmap(file("ramp.pgm", "P2 4 3 255  0 40 80 120  0 40 80 120  0 40 80 120"));
    const Shape shape = shapeOf(ramp, 100, false, "ramp");
    EXPECT_EQ(shape.inside.pointCount(), 3);
    double least = 10;
    for (const Segment& s : shape.boundary) least = std::min({least, s.a.x, s.b.x});
    EXPECT_DOUBLE_EQ(least, 2.5);
    const Shape other = shapeOf(ramp, 100, true, "ramp");
    EXPECT_EQ(other.inside.pointCount(), 9);
}

TEST_F(Images, AShapeAtTheBorderIsClosedHalfAPixelOutside) {
    const Bitmap full = readBitmap(file("full.pgm", "P2 3 3 255  9 9 9  9 9 9  9 9 9"));
    const Shape shape = shapeOf(full, 4.5, false, "full");
    double low = 10, high = -10;
    for (const Segment& s : shape.boundary)
        for (const Point& p : {s.a, s.b}) low = std::min({low, p.x, p.y}), high = std::max({high, p.x, p.y});
    EXPECT_DOUBLE_EQ(low, -0.5);
    EXPECT_DOUBLE_EQ(high, 2.5);
    for (const Fit method : {Fit::binary, Fit::distance}) {
        const Curves curves = extractCurves(fit(shape, method));
        ASSERT_EQ(curves.rings.size(), 1u);
        EXPECT_EQ(validity::complaint(curves.rings), "");
    }
}

// ---- polygons ----

using Polygons = Files;

TEST_F(Polygons, GeojsonOfEveryKindIsRead) {
    const std::string ring = "[[0,0],[4,0],[4,4],[0,4],[0,0]]", hole = "[[1,1],[1,2],[2,2],[2,1],[1,1]]";
    const auto read = [&](const std::string& text) { return readPolygons(file("p.geojson", text)); };
    EXPECT_EQ(read("{\"type\":\"Polygon\",\"coordinates\":[" + ring + "," + hole + "]}").ringCount(), 2u);
    const std::string multi = "{\"type\":\"MultiPolygon\",\"coordinates\":[[" + ring + "],[" + hole + "]]}";
    EXPECT_EQ(read(multi).polygons.size(), 2u);
    const std::string feature = "{\"type\":\"Feature\",\"properties\":null,\"geometry\":" + multi + "}";
    EXPECT_EQ(read(feature).pointCount(), 8u);
    const PolygonInput collection =
        read("{\"type\":\"FeatureCollection\",\"features\":[" + feature +
             ",{\"type\":\"Feature\",\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,2]}}]}");
    EXPECT_EQ(collection.polygons.size(), 2u);
    ASSERT_EQ(collection.remarks.size(), 1u);
    EXPECT_THAT(collection.remarks[0], HasSubstr("Point"));
    EXPECT_EQ(read("{\"type\":\"GeometryCollection\",\"geometries\":[" + multi + "]}").polygons.size(), 2u);
}

TEST_F(Polygons, TopojsonArcsAreStitchedForwardsAndBackwards) {
    const PolygonInput input =
        readPolygons(file("t.json",
                          "{\"type\":\"Topology\",\"transform\":{\"scale\":[0.5,2],\"translate\":[10,20]},"
                          "\"arcs\":[[[0,0],[4,0],[0,4]],[[0,0],[0,4],[4,0]]],"
                          "\"objects\":{\"land\":{\"type\":\"Polygon\",\"arcs\":[[0,-2]]}}}"));
    ASSERT_EQ(input.ringCount(), 1u);
    EXPECT_EQ(input.polygons[0].rings[0], (Ring{{10, 20}, {12, 20}, {12, 28}, {10, 28}}));
    EXPECT_THAT(errorOf([&] {
                    readPolygons(file("t.json",
                                      "{\"type\":\"Topology\",\"arcs\":[[[0,0],[1,1]]],\"objects\":"
                                      "{\"l\":{\"type\":\"Polygon\",\"arcs\":[[7]]}}}"));
                }),
                HasSubstr("arc 7 of 1"));
    EXPECT_THAT(errorOf([&] {  // 2^64 - 1: not arc 0 backwards
                    readPolygons(file("t.json",
                                      "{\"type\":\"Topology\",\"arcs\":[[[0,0],[1,1]]],\"objects\":"
                                      "{\"l\":{\"type\":\"Polygon\",\"arcs\":[[18446744073709551615]]}}}"));
                }),
                HasSubstr("arc 18446744073709551615 of 1"));
}

TEST_F(Polygons, TextOfRings) {
    const PolygonInput input =
        readPolygons(file("r.txt", "# rings\n> first\n0 0\n4 0\n4 4\n0 0\n\n1,1\n2 1\t\n2 2 9\n"));
    ASSERT_EQ(input.polygons.size(), 1u);
    EXPECT_EQ(input.polygons[0].rings.size(), 2u);
    EXPECT_EQ(input.polygons[0].rings[1], (Ring{{1, 1}, {2, 1}, {2, 2}}));
    EXPECT_THAT(input.remarks, IsEmpty());
}

TEST_F(Polygons, AByteOrderMarkIsPassedOver) {
    const std::string mark = "\xef\xbb\xbf";
    const std::string json = "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[4,0],[4,3],[0,0]]]}";
    EXPECT_EQ(readPolygons(file("mark.json", mark + json)).pointCount(), 3u);
    EXPECT_EQ(readPolygons(file("mark.txt", mark + "0 0\r\n4 0\r\n4 3\r\n")).pointCount(), 3u);
}

TEST_F(Polygons, WhatIsRepairedIsSaidWithItsRing) {
    const auto remark = [&](const std::string& rings) {
        const PolygonInput input =
            readPolygons(file("r.geojson", "{\"type\":\"Polygon\",\"coordinates\":[" + rings + "]}"));
        return input.remarks.empty() ? std::string() : input.remarks[0];
    };
    const std::string good = "[[0,0],[4,0],[4,4],[0,4],[0,0]]";
    EXPECT_EQ(remark(good), "");
    EXPECT_THAT(remark(good + ",[[1,1],[1,2],[2,2]]"),
                HasSubstr("not closed, closed (first: polygon 0, ring 1)"));
    EXPECT_THAT(remark(good + ",[[1,1],[1,1],[1,1]]"), HasSubstr("fewer than three"));
    EXPECT_THAT(remark("[[0,0],[4,4],[4,0],[0,4],[0,0]]"),
                HasSubstr("meeting itself; inside is what an odd number of turns surrounds (first: polygon "
                          "0, ring 0 near (2, 2))"));
    EXPECT_THAT(
        remark("[[0,0],[4,0],[4,4],[0,4],[0,0]],[[6,0],[6,1],[7,1],[7,0],[6,0]]"),
        HasSubstr("1 ring is a hole outside of its polygon and adds to it (first: polygon 0, ring 1)"));
    EXPECT_EQ(remark("[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[1,2],[2,2],[2,1],[1,1]]"), "");
    EXPECT_THAT(remark("[[0,0],[4,0],[2,0],[2,4],[0,0]]"), HasSubstr("meeting itself"));  // a spike
}

// A shape that is cut at the antimeridian has a closed outline on each side; one that is not cut would run round the world.
TEST_F(Polygons, AcrossTheAntimeridianAreCutOrRefused) {
    const std::string cut =
        R"({"type":"MultiPolygon","coordinates":[[[[178,0],[180,0],[180,5],[178,5],[178,0]]],)"
        R"([[[-180,0],[-179,0],[-179,5],[-180,5],[-180,0]]]]})";
    EXPECT_EQ(readPolygons(file("cut.geojson", cut)).ringCount(), 2u);
    const Input input = readInput(file("cut.geojson", cut), {.pixels = 720});
    const auto levels = levelCurves(input, {.lastStep = 0});
    ASSERT_EQ(levels[0].drawn.curves.outerCount(), 2u);
    EXPECT_NEAR(levels[0].facts.area, 15, 1.5);
    EXPECT_THAT(errorOf([&] {
                    readPolygons(file(
                        "across.geojson",
                        R"({"type":"Polygon","coordinates":[[[178,0],[-179,0],[-179,5],[178,5],[178,0]]]})"));
                }),
                HasSubstr("crosses the antimeridian between points 0 (178, 0) and 1 (-179, 0)"));
    const std::string polar =
        R"({"type":"Polygon","coordinates":[[[-180,-90],[180,-90],[180,-70],[0,-60],[-180,-70],[-180,-90]]]})";
    EXPECT_EQ(readPolygons(file("polar.geojson", polar)).ringCount(), 1u);
}

// Antarctica as maps of the world hold it: one edge leads over the antimeridian, and the pole itself is no point.
TEST_F(Polygons, ARingAroundAPoleIsCompletedAlongTheBorderOfTheMap) {
    const auto polygon = [&](const std::string& ring) {
        return file("polar.geojson", R"({"type":"Polygon","coordinates":[)" + ring + "]}");
    };
    const PolygonInput south = readPolygons(polygon("[[179,-80],[-179,-84],[0,-70],[179,-80]]"));
    ASSERT_EQ(south.ringCount(), 1u);
    EXPECT_EQ(south.polygons[0].rings[0],
              (Ring{{179, -80}, {180, -82}, {180, -90}, {-180, -90}, {-180, -82}, {-179, -84}, {0, -70}}));
    ASSERT_EQ(south.remarks.size(), 1u);
    EXPECT_EQ(south.remarks[0],
              "1 ring around a pole, completed along the border of the map (first: polygon 0, ring 0)");
    EXPECT_EQ(readPolygons(polygon("[[-180,84],[179,85],[0,70],[-180,84]]")).polygons[0].rings[0],
              (Ring{{-180, 84}, {-180, 90}, {180, 90}, {180, 84}, {179, 85}, {0, 70}}));
    // Neither a shape of which one crossing is the edge that closes it, nor one far from the pole.
    for (const char* ring : {"[[-179,70],[-179,75],[178,75],[178,70]]", "[[-170,0],[170,0],[0,80],[-170,0]]"})
        EXPECT_THAT(errorOf([&] { readPolygons(polygon(ring)); }), HasSubstr("crosses the antimeridian"))
            << ring;
}

TEST_F(Polygons, EveryPrefixAndManyFlippedBytesAreReadOrRefusedInOneLine) {
    const std::string good =
        R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a"},"geometry":)"
        R"({"type":"Polygon","coordinates":[[[0,0],[4.5,0],[4,3e0],[0,0]]]}},{"type":"Feature","geometry":null}]})";
    const auto tryOne = [&](const std::string& text) {
        try {
            EXPECT_GE(readPolygons(file("a.geojson", text)).ringCount(), 1u) << text;
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << text;
            EXPECT_EQ(std::string(error.what()).find("json.exception"), std::string::npos) << error.what();
        }
    };
    for (std::size_t n = 0; n < good.size(); ++n) tryOne(good.substr(0, n));
    std::mt19937 random(7);
    for (int i = 0; i < 3000; ++i) {
        std::string text = good;
        text[random() % text.size()] ^= static_cast<char>(1 << random() % 8);
        tryOne(text);
    }
}

TEST_F(Polygons, AFileOfLinesIsToldWhatItHolds) {
    EXPECT_THAT(errorOf([&] {
                    readPolygons(file("l.geojson", R"({"type":"LineString","coordinates":[[0,0],[1,1]]})"));
                }),
                HasSubstr("of other kinds: 1 (first: LineString); expected Polygon or MultiPolygon; isowave "
                          "curve-levels reads lines"));
}

TEST_F(Polygons, BadOnesAreRefusedInOneLine) {
    const auto error = [&](const std::string& name, const std::string& text) {
        return errorOf([&] { readPolygons(file(name, text)); });
    };
    EXPECT_THAT(error("a.json", ""), HasSubstr("is empty"));
    EXPECT_THAT(error("a.json", "{\"type\":\"Polygon\",\"coord"), HasSubstr("ends in line 1 (byte 24)"));
    EXPECT_THAT(error("a.json", "{}"), HasSubstr("without a \"type\""));
    EXPECT_THAT(error("a.json", "{\"type\":\"Polygon\"}"), HasSubstr("without a list"));
    EXPECT_THAT(error("a.json", "{\"type\":\"Point\",\"coordinates\":[1,2]}"), HasSubstr("no polygon"));
    EXPECT_THAT(error("a.json", "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[\"a\",1],[2,2]]]}"),
                HasSubstr("polygon 0, ring 0: point 1"));
    EXPECT_THAT(error("a.json", "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1e99,1],[2,2]]]}"),
                HasSubstr("point 1 is (1e+99, 1)"));
    std::string deep = "{\"type\":\"Point\"}";
    for (int k = 0; k < 1000; ++k) deep = "{\"type\":\"GeometryCollection\",\"geometries\":[" + deep + "]}";
    EXPECT_THAT(error("a.json", deep), HasSubstr("nests collections more than 100 deep"));
    EXPECT_THAT(error("a.txt", "0 0\n1 nan\n2 2\n"), HasSubstr("coordinates up to 1e9"));
    EXPECT_THAT(error("a.txt", "0 0\nhello\n"), HasSubstr("line 2: 'hello'"));
    EXPECT_THAT(errorOf([&] { readInput(file("thin.txt", "0 0\n100 0.001\n100 0\n"), {.pixels = 10}); }),
                HasSubstr("no pixel's middle"));
}

TEST(SelfIntersection, AgreesWithCgalOnRandomRings) {
    std::mt19937 random(6);
    int simple = 0;
    for (int n = 0; n < 2000; ++n) {
        std::uniform_int_distribution<int> at(0, n % 2 ? 6 : 1000);  // coarse ones touch and overlap often
        Ring ring;
        for (int i = 0; i < 3 + n % 5; ++i) ring.push_back({double(at(random)), double(at(random))});
        ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
        if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
        if (ring.size() < 3) continue;
        Point place;
        const bool expected = validity::toCgal(ring).is_simple();
        ASSERT_EQ(selfIntersection(ring, place), !expected) << n;
        simple += expected;
    }
    EXPECT_GT(simple, 500);
}

// ---- out, and in again ----

using Drawing = Files;

TEST_F(Drawing, GeojsonAndTextComeBackAsTheSameRings) {
    const Curves curves = extractCurves(fit(shapes::target(4), Fit::binary));
    writeGeojson(folder_ / "t.geojson", curves, "a \"name\"");
    writeText(folder_ / "t.txt", curves);
    for (const char* name : {"t.geojson", "t.txt"}) {
        const PolygonInput back = readPolygons(folder_ / name);
        EXPECT_THAT(back.remarks, IsEmpty()) << name;
        ASSERT_EQ(back.ringCount(), curves.rings.size());
        EXPECT_EQ(back.pointCount(), curves.pointCount());
        double area = 0;
        for (const Polygon& polygon : back.polygons)
            for (const Ring& ring : polygon.rings) area += signedArea(ring);
        EXPECT_NEAR(area, curves.area(), 1e-8);
    }
    // Each outer ring with its own hole.
    for (const Polygon& polygon : readPolygons(folder_ / "t.geojson").polygons) {
        ASSERT_EQ(polygon.rings.size(), polygon.rings.size() == 1 ? 1u : 2u);
        EXPECT_GT(signedArea(polygon.rings[0]), 0);
        if (polygon.rings.size() == 2) {
            EXPECT_LT(signedArea(polygon.rings[1]), 0);
            EXPECT_LT(-signedArea(polygon.rings[1]), signedArea(polygon.rings[0]));
        }
    }
}

TEST_F(Drawing, WrittenRingsAreStillSimpleInTheInputsCoordinates) {
    const Input input = readInput(kData / "africa.geojson", {.pixels = 363});
    traceSteps(fit(*input.shape, Fit::distance), 8, Hold::none,
               [&](const StepFacts& facts, const RowField<float>&, const Curves& curves, const Curves&) {
                   if (curves.rings.empty()) return;
                   writeGeojson(folder_ / "a.geojson", curves, "Africa");
                   EXPECT_THAT(readPolygons(folder_ / "a.geojson").remarks, IsEmpty()) << facts.step;
               });
}

TEST_F(Drawing, PngShowsTheAreaAndNorthUp) {
    // A triangle with its tip in the north.
    Curves curves;
    curves.rings.push_back({{{0, 0}, {10, 0}, {5, 10}}, -1, false});
    View view;
    view.extent.take(Point{0, 0});
    view.extent.take(Point{10, 10});
    view.yUp = true;
    writePng(folder_ / "t.png", curves, view, 100);
    const Bitmap bitmap = readBitmap(folder_ / "t.png");
    EXPECT_EQ(bitmap.width, 100);
    EXPECT_EQ(bitmap.height, 100);
    double ink = 0;
    for (const float v : bitmap.values) ink += (255.0 - static_cast<double>(v)) / 255;
    EXPECT_NEAR(ink, 5000, 20);
    EXPECT_EQ(bitmap.at(10, 10), 255);
    EXPECT_EQ(bitmap.at(10, 95), 0);
}

TEST_F(Drawing, SvgHasOneSubpathARing) {
    const RowField<float> field = fit(shapes::target(4), Fit::binary);
    const Curves curves = extractCurves(field);
    View view;
    view.extent.take(Point{0, 0});
    view.extent.take(Point{70, 70});
    writeSvg(folder_ / "a.svg", curves, view);
    writeSvg(folder_ / "b.svg", smoothed(field, curves, 0.05), view);
    std::ofstream(folder_ / "c.svg") << sheetOf({{"1", curves}, {"<2>", curves}}, view);
    const auto count = [&](const char* name, char c) {
        const std::string text = read(folder_ / name);
        const std::string d = text.substr(text.find(" d=\""));
        return static_cast<std::size_t>(std::count(d.begin(), d.end(), c));
    };
    EXPECT_EQ(count("a.svg", 'M'), curves.rings.size());
    EXPECT_EQ(count("a.svg", 'L') + curves.rings.size(), curves.pointCount());
    EXPECT_EQ(count("b.svg", 'M'), curves.rings.size());
    EXPECT_GE(count("b.svg", 'C'), curves.pointCount());
    EXPECT_EQ(count("c.svg", 'M'), 2 * curves.rings.size());
    EXPECT_THAT(read(folder_ / "c.svg"), HasSubstr("&lt;2>"));
}

TEST_F(Drawing, AnUnwritableFolderIsAnOperationError) {
    EXPECT_THROW(writeText(folder_ / "no" / "t.txt", Curves{}), OperationError);
    EXPECT_THROW(writePng(folder_ / "no" / "t.png", extractCurves(fit(shapes::disc(5), Fit::binary)),
                          View{{{0, 0}, {9, 9}}, false}),
                 OperationError);
}

// ---- real inputs ----

TEST(RealInputs, AfricaKeepsItsAreaAndItsRingsAreValidAtEveryStep) {
    for (const Fit method : {Fit::binary, Fit::distance}) {
        const Input input = readInput(kData / "africa.geojson", {.pixels = 363});
        EXPECT_THAT(input.remarks, IsEmpty());
        std::vector<StepFacts> facts;
        const Ladder ladder =
            traceSteps(fit(*input.shape, method), std::nullopt, Hold::local,
                       [&](const StepFacts& f, const RowField<float>&, const Curves& curves, const Curves&) {
                           EXPECT_EQ(validity::complaint(curves.rings), "") << f.step;
                           facts.push_back(f);
                       });
        for (int step = 2; step <= 6; ++step)
            EXPECT_NEAR(facts[step].area / facts[0].area, 1, 0.01) << step;  // seen 0.002
        EXPECT_GT(facts[0].rings, 15u);
        EXPECT_LE(facts[6].rings, 3u);
        EXPECT_LT(facts[2].rmsToLevel0, 0.12 * input.pixel);  // seen 0.09, 0.10
        EXPECT_EQ(facts.back().points, 0u) << "nothing is left, and the ladder ends";
        for (std::size_t s = 0; s + 1 < facts.size(); ++s) EXPECT_GT(facts[s].points, 0u) << s;
        EXPECT_LT(static_cast<double>(ladder.coefficients) / static_cast<double>(ladder.controlPoints), 1.4);
    }
}

TEST(RealInputs, SilhouettesWithHolesAreValidAtEveryStep) {
    for (const char* name : {"keyring.png", "horse.png"})
        for (const Fit method : {Fit::binary, Fit::distance}) {
            const Input input = readInput(kData / name);
            std::size_t holes = 0;
            traceSteps(fit(*input.shape, method), std::nullopt, Hold::local,
                       [&](const StepFacts& f, const RowField<float>&, const Curves& curves, const Curves&) {
                           EXPECT_EQ(validity::complaint(curves.rings), "") << name << f.step;
                           holes = std::max(holes, f.holes);
                       });
            if (std::string(name) == "keyring.png") {
                EXPECT_GT(holes, 40u);  // seen 47
            }
        }
}

// ---- the ladder, as a library user climbs it ----

TEST(LadderOfCurves, IsTheSameForAnyNumberOfThreads) {
    std::vector<std::string> drawn[2];
    for (int i = 0; i < 2; ++i) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, i ? 4 : 1);
        Input input = readInput(kData / "keyring.png");
        const View view = viewOf(input);
        makeLadder(std::move(input), {}, [&](const LadderStep& step) {
            if (step.level()) drawn[i].push_back(svg(step.curves(), view));
        });
    }
    EXPECT_EQ(drawn[0], drawn[1]);
    EXPECT_GT(drawn[0].size(), 4u);
}

TEST(LadderOfCurves, VisitsTheStepsThatAreAskedForAndSaysHowTheFitWent) {
    std::vector<std::string> names;
    const Ladder ladder = makeLadder(readInput(kData / "africa.geojson", {.pixels = 120}),
                                     {.halfWidth = 1.5, .firstStep = 2, .lastStep = 4},
                                     [&](const LadderStep& step) { names.push_back(step.name()); });
    EXPECT_THAT(names, testing::ElementsAre("L1", "L1a", "L2"));
    EXPECT_EQ(ladder.steps.size(), 5u) << "finer ones are measured, too";
    EXPECT_EQ(ladder.fit, Fit::distance);
    EXPECT_EQ(ladder.band, 1.5) << "no wider than the distances are known";
    EXPECT_EQ(ladder.fitReport.disagreeing, 0);
    EXPECT_TRUE(ladder.fitReport.repairAgreed);
    EXPECT_DOUBLE_EQ(ladder.fitReport.repairFloor, 1e-4 / 1.5);
    EXPECT_GT(ladder.coefficients, ladder.controlPoints);
    const Ladder whole = makeLadder(readInput(kData / "africa.geojson", {.pixels = 120}), {}, {});
    EXPECT_EQ(whole.steps.back().points, 0u);
    EXPECT_GT(whole.steps[whole.steps.size() - 2].points, 0u);
}

TEST(LadderOfCurves, DrawsWithinTheToleranceAndSmoothly) {
    const auto levels =
        levelCurves(readInput(kData / "keyring.png"), {.lastStep = 4}, {.tolerance = 0.05, .smooth = true});
    ASSERT_EQ(levels.size(), 3u);
    for (const LevelCurves& level : levels) {
        ASSERT_TRUE(level.drawn.smooth);
        EXPECT_LE(level.drawn.smooth->deviation, 0.05);
        EXPECT_EQ(level.drawn.smooth->rings.size(), level.facts.rings + level.facts.holes);
    }
    const auto crossings = levelCurves(readInput(kData / "keyring.png"), {.lastStep = 0});
    const auto finer = levelCurves(readInput(kData / "keyring.png"), {.lastStep = 0}, {.tolerance = 0.01});
    EXPECT_FALSE(crossings[0].drawn.smooth);
    EXPECT_GT(finer[0].drawn.curves.pointCount(), crossings[0].drawn.curves.pointCount());
}

TEST(LadderOfCurves, TakesValuesAndPolygonsFromMemory) {
    std::vector<float> disc(64 * 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            disc[static_cast<std::size_t>(64 * y + x)] =
                20 - static_cast<float>(std::hypot(x - 31.5, y - 31.5));
    const auto levels = levelCurves(pictureInput(64, 64, disc, {.iso = 0}), {.lastStep = 2});
    EXPECT_EQ(levels[1].facts.rings, 1u);
    EXPECT_NEAR(levels[1].facts.area, M_PI * 20 * 20, 5);
    EXPECT_THAT(errorOf([] { pictureInput(3, 3, {1, 2}); }), HasSubstr("no picture of 3 x 3 pixels"));
    const Polygon square{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {{4, 4}, {6, 4}, {6, 6}, {4, 6}}}};
    const Input input = polygonInput({square}, {.pixels = 100});
    EXPECT_EQ(input.kind, "1 polygons of 2 rings, 8 points");
    const auto drawn = levelCurves(input, {.lastStep = 0});
    EXPECT_NEAR(drawn[0].facts.area, 96, 0.2);
    EXPECT_EQ(drawn[0].facts.holes, 1u);
    EXPECT_THAT(geojson(drawn[0].drawn.curves, "square"), HasSubstr("\"name\":\"square\""));
    EXPECT_THAT(gmtText(drawn[0].drawn.curves), HasSubstr("> hole in 0"));
}

// ---- distances ----

TEST(SegmentTree, AgreesWithAllPairs) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> at(0, 100), small(-3, 3);
    std::vector<Segment> segments;
    for (int i = 0; i < 500; ++i) {
        const Point a{at(random), at(random)};
        segments.push_back({a, a + Point{small(random), small(random)}});
    }
    const SegmentTree tree(segments);
    for (int i = 0; i < 500; ++i) {
        const Point p{1.4 * at(random) - 20, 1.4 * at(random) - 20};
        double best = INFINITY;
        for (const Segment& s : segments) best = std::min(best, squaredDistance(p, s));
        ASSERT_DOUBLE_EQ(tree.distance(p), std::sqrt(best));
    }
    EXPECT_EQ(SegmentTree({}).distance({0, 0}), INFINITY);
}

TEST(Ladder, DistancesOfShiftedCurvesAreTheShift) {
    Curves square;
    square.rings.push_back({{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, -1, false});
    Curves larger = square;
    larger.rings[0].points = {{-1, -1}, {11, -1}, {11, 11}, {-1, 11}};
    const Distance d = distanceTo(SegmentTree(segmentsOf(square)), larger, 0.1);
    EXPECT_NEAR(d.rms, 1, 0.03);
    EXPECT_GT(d.max, 1.3);
    EXPECT_LE(d.max, std::sqrt(2.0));
}

}  // namespace
}  // namespace isowave::curves2d
