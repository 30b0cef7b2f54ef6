#include "subdivision/filter_catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isowave/filters.h"
#include "tests/subdivision/refusal.h"

namespace isowave::subdivision {
namespace {

using testing::HasSubstr;

std::vector<std::string> valuesOf(const Filter& filter) {
    std::vector<std::string> values;
    for (const FilterTap& tap : filter.taps) values.push_back(tap.value);
    return values;
}

TEST(FilterSet, OfTheCubicHoldsRationalsTheirDoublesAndTheProof) {
    const FilterSet cubic = filterSet("cubic", 7);
    EXPECT_EQ(valuesOf(cubic.a),
              (std::vector<std::string>{"23/196", "-23/49", "9/28", "52/49", "9/28", "-23/49", "23/196"}));
    EXPECT_EQ(cubic.a.taps[0].x, -3);
    EXPECT_DOUBLE_EQ(cubic.a.taps[0].number, 23.0 / 196);
    EXPECT_EQ(cubic.b.size(), 1u);
    EXPECT_EQ(cubic.b[0].x, 1);
    EXPECT_EQ(cubic.failure, "");
    EXPECT_GT(cubic.products, 10u);
    EXPECT_EQ(valuesOf(filterSet("cubic").a), valuesOf(cubic.a)) << "7 is the usual width";
}

TEST(FilterSet, OfAMaskOfOnesOwnIsTheNamedOne) {
    const FilterSet own = maskFilterSet("1/8 1/2 3/4 1/2 1/8", Lattice::Line, 7), named = filterSet("cubic");
    EXPECT_EQ(valuesOf(own.p), valuesOf(named.p));
    EXPECT_EQ(valuesOf(own.a), valuesOf(named.a));
    EXPECT_EQ(valuesOf(own.b[0]), valuesOf(named.b[0]));
    EXPECT_EQ(valuesOf(own.q[0]), valuesOf(named.q[0]));
    EXPECT_EQ(maskFilterSet("-1/16,0,9/16,1,9/16,0,-1/16").failure, "");
    EXPECT_EQ(maskFilterSet("1 1/2 1/2 1/2 1/2 1/2 1/2", Lattice::Triangular, 2).width, 2);
    EXPECT_EQ(filterSet("catmull-clark").q.size(), 3u);
}

TEST(FilterSet, RefusesWithTheReason) {
    EXPECT_THAT(complaint([] { filterSet("nurbs"); }), HasSubstr("chaikin, cubic, dlg"));
    EXPECT_THAT(complaint([] { filterSet("cubic", 1); }), HasSubstr("the smallest that exists has 3 taps"));
    EXPECT_THAT(complaint([] { maskFilterSet("1/2 1/2 1/2 1/2"); }), HasSubstr("not injective"));
    EXPECT_THAT(complaint([] { maskFilterSet("1/2 x"); }), HasSubstr("number 2"));
    EXPECT_THAT(complaint([] { boundaryFilters("catmull-clark"); }), HasSubstr("no boundary rules"));
}

TEST(BoundaryFilters, OfACurveGoOnUntilTheyRepeat) {
    const BoundaryFilters cubic = boundaryFilters("cubic-7");
    for (const char letter : {'P', 'A', 'B', 'Q'}) {
        std::size_t count = 0, last = 0;
        for (const BoundaryDiagram& d : cubic.diagrams) {
            if (d.filter != letter) continue;
            EXPECT_EQ(d.number, count++);
            last += d.asInside;
        }
        EXPECT_GE(count, 2u) << letter;
        EXPECT_EQ(last, 1u) << letter;
    }
    EXPECT_EQ(cubic.finePoints, 2 * cubic.coarsePoints - 3);
}

TEST(BoundaryFilters, OfASurfaceAreThePrintedOnes) {
    const BoundaryFilters butterfly = boundaryFilters("butterfly-3");
    ASSERT_EQ(butterfly.diagrams.size(), 7u);
    const BoundaryDiagram& oneLevelIn = butterfly.diagrams[4];
    EXPECT_EQ(oneLevelIn.place, "one level in");
    EXPECT_EQ(oneLevelIn.diagram.size(), 33u);
    EXPECT_NEAR(toDouble(oneLevelIn.diagram.normSquared()), 0.67876505, 1e-8);
}

}  // namespace
}  // namespace isowave::subdivision
