// What `isowave filters` prints.
#include "tools/report/filters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "subdivision/filters/masks.h"
#include "tools/report/filters_svg.h"

namespace isowave::tools {
namespace {

using namespace subdivision;
using testing::HasSubstr;

Json jsonOfNamed(const char* name) {
    const Filters filters = namedFilters(name, std::nullopt);
    return Json::parse(jsonOf(filters, prove(filters)));
}

std::string textOfNamed(const char* name) {
    const Filters filters = namedFilters(name, std::nullopt);
    return textOf(filters, prove(filters));
}

TEST(Picture, OfARowShowsItsCentreInBrackets) {
    EXPECT_EQ(picture(construct(namedMask("cubic"), 7).a, Lattice::Line, {}),
              "1/196 x  23   -92   63  [208]  63   -92   23 \n");
}

TEST(Picture, OfAHexagonMovesEachRowByHalfACell) {
    EXPECT_EQ(picture(construct(namedMask("butterfly"), 3).a, Lattice::Triangular, {}),
              "1/71 x\n"
              "       -2  2   2   -2\n"
              "     2   1   -6  1   2\n"
              "   2   -6  4   4   -6  2\n"
              " -2  1   4  [65] 4   1   -2\n"
              "   2   -6  4   4   -6  2\n"
              "     2   1   -6  1   2\n"
              "       -2  2   2   -2\n");
}

TEST(Picture, AsSvgHoldsEveryValueOnce) {
    const std::string text = svg(construct(namedMask("butterfly"), 3).a, Lattice::Triangular, {}, "A");
    std::size_t marks = 0;
    for (std::size_t k = text.find("stroke=\"#222\" stroke-width=\"0.8\""); k != std::string::npos;
         k = text.find("stroke=\"#222\" stroke-width=\"0.8\"", k + 1)) {
        ++marks;
    }
    EXPECT_EQ(marks, 36u);  // and the centre, drawn thicker
    EXPECT_THAT(text, HasSubstr("</svg>"));
}

TEST(Json, OfFiltersKeepsTheRationals) {
    const auto cubic = jsonOfNamed("cubic-7");
    EXPECT_EQ(cubic["version"], 1);
    EXPECT_EQ(cubic["A"]["values"][0], "23/196");
    EXPECT_EQ(cubic["A"]["nodes"][0], -3);
    EXPECT_EQ(cubic["B"][0]["centre"], 1) << "a number on the line";
    EXPECT_EQ(cubic["proof"]["holds"], true);
    const auto loop = jsonOfNamed("loop-1");
    EXPECT_EQ(loop["Q"].size(), 3u);
    EXPECT_EQ(loop["Q"][0]["centre"], (std::vector<int>{1, 0})) << "a pair elsewhere";
    EXPECT_EQ(loop["Q"][0]["nodes"][0].size(), 2u);
}

TEST(FiltersText, SaysThatTheyAreProved) {
    EXPECT_THAT(textOfNamed("cubic"), HasSubstr("AP = I, BP = 0, AQ = 0, BQ = I: proved ("));
    EXPECT_THAT(textOfNamed("cubic"), HasSubstr("1/196 x  23   -92   63  [208]  63   -92   23"));
    const Filters own =
        maskFilters(customMask(Lattice::Triangular, parseRationals("1 1/2 1/2 1/2 1/2 1/2 1/2")), 2);
    EXPECT_THAT(textOf(own, prove(own)), HasSubstr("triangular lattice, A of width 2"));
}

TEST(FiltersText, OfABoundaryHoldsThePrintedNumbers) {
    EXPECT_THAT(textOf(boundaryFilters("butterfly-3")), HasSubstr("33 taps, squared norm 0.67876505"));
    EXPECT_THAT(textOf(boundaryFilters("cubic-7")), HasSubstr("1/139 x  -49   98  [135]  -60   15"));
    EXPECT_THAT(textOf(boundaryFilters("cubic-7")), HasSubstr(", as inside\n"));
}

}  // namespace
}  // namespace isowave::tools
