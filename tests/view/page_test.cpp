// Distances of a page, and what the html holds.
#include "view/page.h"

#include <zlib.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "isowave/measure.h"
#include "tests/view/shapes.h"
#include "view/mesh_packing.h"

namespace isowave::view {
namespace {

Bytes bytesOf(const std::string& text) { return {text.begin(), text.end()}; }

// ---- bytes

TEST(TextBytes, Base64HasTheVectorsOfRfc4648) {
    const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                           {"f", "Zg=="},
                                                           {"fo", "Zm8="},
                                                           {"foo", "Zm9v"},
                                                           {"foob", "Zm9vYg=="},
                                                           {"fooba", "Zm9vYmE="},
                                                           {"foobar", "Zm9vYmFy"}};
    for (const auto& [plain, coded] : vectors) EXPECT_EQ(base64(bytesOf(plain)), coded);
    EXPECT_EQ(base64({0xff, 0xfe, 0xfd}), "//79");
}

TEST(TextBytes, WhatIsDeflatedInflates) {
    Bytes bytes(100'000);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * i >> 3);
    const Bytes small = deflated(bytes);
    Bytes back(bytes.size());
    uLongf size = back.size();
    ASSERT_EQ(uncompress(back.data(), &size, small.data(), small.size()), Z_OK);
    EXPECT_EQ(back, bytes);
}

// ---- distances

TEST(SurfaceDistance, OfParallelSheetsIsTheirGap) {
    const DistanceSummary summary = SurfaceDistance(sheet(12)).of(sheet(12, 0.75));
    EXPECT_DOUBLE_EQ(summary.max, 0.75);
    EXPECT_NEAR(summary.rms, 0.75, 1e-12);
    EXPECT_EQ(summary.ofVertex.size(), 169u);
    EXPECT_NEAR(summary.histogram.back(), 1, 1e-12);
}

// A tilted sheet: distances run evenly from 0 to h, so their mean square is h^2 / 3 and every bin holds as much.
TEST(SurfaceDistance, OfATiltedSheetIsEven) {
    TriangleMesh tilted = sheet(96);
    for (Point& p : tilted.points) p[2] = p[0] / 96;
    TriangleMesh ground = sheet(96);
    const DistanceSummary summary = SurfaceDistance(ground).of(tilted);
    EXPECT_NEAR(summary.rms, std::sqrt(1.0 / 3), 1e-6);
    for (const double share : summary.histogram) EXPECT_NEAR(share, 1.0 / DistanceSummary::kBins, 0.008);
}

TEST(SurfaceDistance, HasTheRmsAndMaxOfReports) {
    if (!canMeasureDistances()) GTEST_SKIP() << "no distances in a build without CGAL's GPL packages";
    TriangleMesh swollen = torus(40, 24);
    for (Point& p : swollen.points) p[2] *= 1.3 + 0.1 * std::sin(p[0]);
    const TriangleMesh plain = torus(96, 64);
    const OneSidedDistance report = compareMeshes(swollen, plain).aToB;
    const DistanceSummary mine = SurfaceDistance(plain).of(swollen);
    EXPECT_NEAR(mine.rms, report.rms, 1e-7 * report.rms);
    EXPECT_NEAR(mine.max, report.max, 1e-7 * report.max);
}

TEST(SurfaceDistance, SharesSumToOneAndAgreeWithTheRms) {
    const DistanceSummary summary = SurfaceDistance(torus(96, 64)).of(torus(12, 8));
    EXPECT_NEAR(std::accumulate(summary.histogram.begin(), summary.histogram.end(), 0.0), 1, 1e-12);
    double square = 0;
    for (int i = 0; i < DistanceSummary::kBins; ++i) {
        const double middle = (i + 0.5) / DistanceSummary::kBins * summary.max;
        square += summary.histogram[static_cast<std::size_t>(i)] * middle * middle;
    }
    EXPECT_NEAR(std::sqrt(square), summary.rms, summary.max / DistanceSummary::kBins);
}

TEST(CurveDistance, OfASquareInASquareIsTheGap) {
    const Rings outer = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}}, inner = {{{1, 1}, {3, 1}, {3, 3}, {1, 3}}};
    const DistanceSummary summary = CurveDistance(outer).of(inner);
    EXPECT_DOUBLE_EQ(summary.max, 1);
    EXPECT_DOUBLE_EQ(summary.rms, 1);
}

// ---- html

class PageTest : public testing::Test {
  protected:
    void SetUp() override {
        if (!canMakePages()) GTEST_SKIP() << "three.js was not there when this build was configured";
    }
};

nlohmann::json documentOf(const std::string& html) {
    const std::string begin = "id=\"document\">";
    const auto from = html.find(begin) + begin.size();
    return nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
}

TEST_F(PageTest, HoldsALevelForEveryMesh) {
    Page page({.title = "torus", .unit = "mm"});
    page.add({.name = "L0", .step = 0}, torus(48, 32));
    page.add({.name = "L1", .step = 3, .rms = 0.125}, torus(24, 16));
    const nlohmann::json document = documentOf(page.html());
    ASSERT_EQ(document["levels"].size(), 2u);
    EXPECT_EQ(document["levels"][1]["facts"]["triangles"], 768);
    EXPECT_EQ(document["levels"][1]["facts"]["rms"], 0.125) << "a report's number stays";
    EXPECT_FALSE(document["levels"][0].contains("distance"));
    EXPECT_NEAR(page.largestRounding(), 4.0 / 65535, 1e-9);
    EXPECT_NE(page.html().find("id=\"mesh1\""), std::string::npos);
    EXPECT_NE(page.html().find("id=\"distance1\""), std::string::npos);
}

TEST_F(PageTest, NamesAreNeverMarkup) {
    const std::string bad = "</script><script>alert(1)</script><!--";
    Page page({.title = bad});
    page.add({.name = bad, .file = bad}, torus(6, 6));
    const std::string html = page.html();
    EXPECT_EQ(html.find("alert(1)</script>"), std::string::npos);
    EXPECT_EQ(documentOf(html)["title"], bad);
}

TEST_F(PageTest, AsksNobody) {
    Page page({.title = "torus"});
    page.add({.name = "L0"}, torus(6, 6));
    const std::string html = page.html();
    EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
    for (const char* request : {" src=\"", "@import", "<link rel=\"stylesheet\""})
        EXPECT_EQ(html.find(request), std::string::npos) << request;
}

TEST_F(PageTest, IsTheSameTwice) {
    const auto make = [] {
        Page page({.title = "torus"});
        page.add({.name = "L0"}, torus(40, 30));
        page.add({.name = "L1"}, torus(20, 15));
        return page.html();
    };
    EXPECT_EQ(make(), make());
}

}  // namespace
}  // namespace isowave::view
