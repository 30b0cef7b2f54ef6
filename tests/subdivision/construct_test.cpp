// Filters of masks, in exact rationals: each number was published (B, O) or derived by hand from the
// identities.
#include "subdivision/filters/construct.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isowave/error.h"
#include "subdivision/filters/exact_solve.h"
#include "subdivision/filters/masks.h"
#include "tests/subdivision/numbers.h"
#include "tests/subdivision/refusal.h"

namespace isowave::subdivision {
namespace {

using testing::HasSubstr;

TEST(Rational, IsReadAndWrittenExactly) {
    EXPECT_EQ(toString(q("46/98")), "23/49");
    EXPECT_EQ(q("-0.125"), Rational(-1, 8));
    EXPECT_EQ(q("1.5/2"), Rational(3, 4));
    for (const char* bad : {"", "x", "1/0", "1/", "1e3", "--2", "1/2/3"})
        EXPECT_THROW(parseRational(bad), InputError) << bad;
    EXPECT_THAT(complaint([] { parseRationals("1 2 x"); }), HasSubstr("number 3"));
}

TEST(Rational, BecomesTheNearestDouble) {
    EXPECT_EQ(toDouble(Rational(1, 3)), 1.0 / 3.0);
    EXPECT_EQ(toDouble(Rational(-2, 3)), -2.0 / 3.0);  // truncation would give the neighbour
    EXPECT_EQ(toDouble(Rational(0)), 0.0);
}

TEST(ExactSolve, LeastNormIsOrthogonalToTheNullspace) {
    const Matrix e = {
        {1, 2, 3, 4}, {0, Rational(1, 3), 1, 1}, {1, Rational(7, 3), 4, 5}};  // the third is the sum
    const auto x = leastNorm(e, {1, 2, 3});
    ASSERT_TRUE(x);
    for (const auto& n : nullspace(e)) {
        Rational product = 0;
        for (std::size_t k = 0; k < 4; ++k) product += n[k] * (*x)[k];
        EXPECT_EQ(product, 0);
    }
    EXPECT_EQ((*x)[0] + 2 * (*x)[1] + 3 * (*x)[2] + 4 * (*x)[3], 1);
    EXPECT_EQ(rank(e), 2);
    EXPECT_FALSE(leastNorm(e, {1, 2, 4})) << "the rows are dependent, the right sides are not";
}

// ---- diagrams ----

TEST(Diagram, SpiralStartsAboveAndRunsClockwise) {
    const auto nodes = spiral(Lattice::Triangular, {}, 2);
    const std::vector<Node> expected = {{0, 0},   {0, 1},  {1, 0},  {1, -1}, {0, -1}, {-1, 0}, {-1, 1},
                                        {0, 2},   {1, 1},  {2, 0},  {2, -1}, {2, -2}, {1, -2}, {0, -2},
                                        {-1, -1}, {-2, 0}, {-2, 1}, {-2, 2}, {-1, 2}};
    EXPECT_EQ(nodes, expected);
}

TEST(Diagram, ABallOfWidthWHasTheNodesOfItsRings) {
    for (int w = 0; w <= 5; ++w) {
        EXPECT_EQ(spiral(Lattice::Line, {}, w).size(), static_cast<std::size_t>(2 * w + 1));
        EXPECT_EQ(spiral(Lattice::Triangular, {}, w).size(), static_cast<std::size_t>(1 + 3 * w * (w + 1)));
        EXPECT_EQ(spiral(Lattice::Quad, {}, w).size(), static_cast<std::size_t>((2 * w + 1) * (2 * w + 1)));
        for (const Lattice l : {Lattice::Line, Lattice::Triangular, Lattice::Quad}) {
            for (const Node n : ring(l, {3, 0}, w)) EXPECT_EQ(distance(l, {3, 0}, n), w);
        }
    }
}

TEST(Diagram, InnerProductsDoNotDependOnWhereBothAre) {
    const Diagram a = line(-1, "1/2 3 -1/7"), b = line(0, "5 2");
    EXPECT_EQ(inner(a, b), Rational(15) - Rational(2, 7));
    EXPECT_EQ(inner(a.shifted({7, 3}), b.shifted({7, 3})), inner(a, b));
    EXPECT_EQ(inner(a, b.shifted({0, 1})), 0);
}

TEST(Diagram, ForgetsZeros) {
    Diagram a = line(0, "1 2");
    a.add(at(1), -2);
    EXPECT_EQ(a, line(0, "1"));
    EXPECT_EQ(a[at(1)], 0);
}

// ---- the line ----

TEST(Cubic, HasNoAOfWidthOneAndSaysWhichIsTheSmallest) {
    EXPECT_THAT(complaint([] { construct(namedMask("cubic"), 1); }),
                HasSubstr("the smallest that exists has 3 taps"));
}

TEST(Cubic, FilterAByWidth) {
    const Mask cubic = namedMask("cubic");
    EXPECT_EQ(construct(cubic, 3).a, line(-1, "-1/2 2 -1/2"));
    EXPECT_EQ(construct(cubic, 5).a, construct(cubic, 3).a);
    EXPECT_EQ(construct(cubic, 7).a, line(-3, "23/196 -23/49 9/28 52/49 9/28 -23/49 23/196"));  // B(2.11)
    EXPECT_EQ(construct(cubic, 9).a, construct(cubic, 7).a);
    EXPECT_EQ(construct(cubic, 11).a,
              line(-5,
                   "-569/12038 1138/6019 -141/926 -2024/6019 4479/12038 5714/6019 4479/12038 "
                   "-2024/6019 -141/926 1138/6019 -569/12038"));
    EXPECT_EQ(construct(cubic, 13).a, construct(cubic, 11).a);
}

TEST(Cubic, FiltersBAndQ) {
    const Mask cubic = namedMask("cubic");
    const Diagram fourth = line(-1, "1 -4 6 -4 1");
    EXPECT_EQ(construct(cubic, 3).b[0], fourth.scaled(q("1/4")));
    EXPECT_EQ(construct(cubic, 3).q[0], line(0, "1/4 1 1/4"));
    EXPECT_EQ(construct(cubic, 7).b[0], fourth.scaled(q("13/98")));  // B(2.13)
    EXPECT_EQ(construct(cubic, 7).q[0],
              line(-2, "-23/208 -23/52 -63/208 1 -63/208 -23/52 -23/208"));  // B(2.14)
    EXPECT_EQ(construct(cubic, 11).b[0], fourth.scaled(q("2857/24076")));
}

TEST(Chaikin, Filters) {
    const Mask chaikin = namedMask("chaikin");
    const Diagram third = line(-1, "-1 3 -3 1");
    const Filters four = construct(chaikin, 4), eight = construct(chaikin, 8);
    EXPECT_EQ(four.a, line(-1, "-1/4 3/4 3/4 -1/4"));
    EXPECT_EQ(four.b[0], third.scaled(q("3/16")));
    EXPECT_EQ(four.q[0], line(-1, "1/3 1 -1 -1/3"));
    EXPECT_EQ(eight.a, line(-3, "3/40 -9/40 -1/40 27/40 27/40 -1/40 -9/40 3/40"));
    EXPECT_EQ(eight.b[0], third.scaled(q("27/160")));
    EXPECT_EQ(eight.q[0], line(-3, "-1/9 -1/3 1/27 1 -1 -1/27 1/3 1/9"));
}

TEST(DynLevinGregory, LeastNormFilters) {
    const Mask dlg = namedMask("dlg");
    for (int width : {1, 3, 5, 7}) EXPECT_EQ(construct(dlg, width).a, Diagram::delta({})) << width;
    EXPECT_EQ(construct(dlg, 9).a, line(-4, "3/161 0 -24/161 48/161 107/161 48/161 -24/161 0 3/161"));
    EXPECT_EQ(construct(dlg, 13).a[{}], q("21755/33553"));
    EXPECT_EQ(construct(dlg, 9).b[0], line(-2, "1/16 0 -9/16 1 -9/16 0 1/16"));  // O(2) lost the sign of 1/16
    // The last tap of O's optimal filter is printed without its sign; with -3/161 it would not reproduce P's
    // columns.
    Diagram minus = construct(dlg, 9).a;
    minus.add(at(4), q("-6/161"));
    minus.add(at(-4), q("-6/161"));
    EXPECT_THAT(complaint([&] { constructWith(dlg, minus); }), HasSubstr("not a left inverse of P"));
}

TEST(OwnMask, IsTheNamedOneWhenTheTapsAre) {
    const Filters own = construct(customMask(Lattice::Line, parseRationals("1/8 1/2 3/4 1/2 1/8")), 7);
    EXPECT_EQ(own.a, construct(namedMask("cubic"), 7).a);
    EXPECT_EQ(bspline(3).p, namedMask("cubic").p);
    EXPECT_EQ(bspline(2).p, namedMask("chaikin").p);
}

TEST(OwnMask, EveryBSplineHasFilters) {
    for (int degree = 1; degree <= 7; ++degree) {
        const Mask mask = bspline(degree);
        const auto width = smallestWidth(mask, 41);
        ASSERT_TRUE(width) << degree;
        EXPECT_TRUE(prove(construct(mask, *width))) << degree;
        EXPECT_TRUE(prove(construct(mask, *width + 6))) << degree;
    }
}

TEST(OwnMask, NotSymmetricHasFiltersToo) {  // Daubechies-like lengths, arbitrary values
    const Filters f = construct(customMask(Lattice::Line, parseRationals("1/3 5/7 2/3 2/7")), 4);
    EXPECT_TRUE(prove(f));
    EXPECT_GT(prove(f).products, 8u);
}

TEST(BadMask, IsRefusedWithTheReason) {
    const auto tell = [](const char* taps, int width) {
        return complaint([&] { construct(customMask(Lattice::Line, parseRationals(taps)), width); });
    };
    // (1 + z)^2 in both halves: alternating sequences vanish.
    EXPECT_THAT(tell("1/2 1/2 1/2 1/2", 4),
                HasSubstr("not injective: its even and odd taps share the factor 1 + z"));
    EXPECT_THAT(tell("1 2 0 0 -1 -2", 8), HasSubstr("-1 + z^2"));
    EXPECT_THAT(tell("0 0 0", 3), HasSubstr("no tap"));
    EXPECT_THAT(tell("1/8 1/2 3/4 1/2 1/8", 4), HasSubstr("take 5"));
    EXPECT_THAT(tell("1/8 1/2 3/4 1/2 1/8", 0), HasSubstr("too small"));
    EXPECT_THAT(tell("1/8 1/2 3/4 1/2 1/8", 1001), HasSubstr("too large"));
    EXPECT_THAT(complaint([] { namedMask("doo"); }),
                HasSubstr("chaikin, cubic, dlg, butterfly, loop, catmull-clark"));
}

TEST(Proof, FailsWhenOneValueIsWrong) {
    for (const char* name : {"cubic", "butterfly", "loop"}) {
        const Filters right = construct(namedMask(name), std::string(name) == "cubic" ? 7 : 3);
        ASSERT_TRUE(prove(right));
        const auto wrong = [&](Diagram Filters::*which) {
            Filters f = right;
            (f.*which).add((f.*which).begin()->first, q("1/1000000000000000000"));
            return prove(f).failure;
        };
        EXPECT_THAT(wrong(&Filters::a), HasSubstr("AP"));
        for (std::size_t k = 0; k < right.b.size(); ++k) {
            Filters f = right;
            f.b[k].add(f.b[k].begin()->first, 1);
            EXPECT_THAT(prove(f).failure, HasSubstr("BP")) << name << k;
            f = right;
            f.q[k].add(f.q[k].begin()->first, 1);
            EXPECT_FALSE(prove(f)) << name << k;
        }
        Filters f = right;
        f.b.pop_back();
        f.q.pop_back();
        EXPECT_THAT(prove(f).failure, HasSubstr("number of details"));
    }
}

// ---- the triangular lattice ----

// Values by ring: `corners` are the ring's nodes on the six axes.
struct RingValues {
    std::set<Rational> corners, others;
};
RingValues ringValues(const Diagram& diagram, int k) {
    RingValues values;
    const auto nodes = ring(Lattice::Triangular, {}, k);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        (i % static_cast<std::size_t>(k) == 0 ? values.corners : values.others).insert(diagram[nodes[i]]);
    }
    return values;
}
using Set = std::set<Rational>;

TEST(Butterfly, MaskHasItsTwentyFiveTaps) {
    const Diagram p = namedMask("butterfly").p;
    std::map<Rational, int> count;
    for (const auto& [node, value] : p) ++count[value];
    EXPECT_EQ(count, (std::map<Rational, int>{{1, 1}, {q("1/2"), 6}, {q("1/8"), 6}, {q("-1/16"), 12}}));
}

TEST(Butterfly, WidthsUpToTwoAreTrivial) {
    for (int width : {0, 1, 2}) {
        const Filters f = construct(namedMask("butterfly"), width);
        EXPECT_EQ(f.a, Diagram::delta({}));
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(f.q[k], Diagram::delta(f.details[k]));
        std::map<Rational, int> count;
        for (const auto& [node, value] : f.b[0]) ++count[value];
        EXPECT_EQ(count, (std::map<Rational, int>{{1, 1}, {q("-1/2"), 2}, {q("-1/8"), 2}, {q("1/16"), 4}}));
    }
}

TEST(Butterfly, WidthThree) {
    const Filters f = construct(namedMask("butterfly"), 3);
    const Diagram a = f.a.scaled(71);
    EXPECT_EQ(a.size(), 37u);
    EXPECT_EQ(a[{}], 65);
    EXPECT_EQ(ringValues(a, 1).corners, Set{4});
    EXPECT_EQ(ringValues(a, 2).corners, Set{1});
    EXPECT_EQ(ringValues(a, 2).others, Set{-6});
    EXPECT_EQ(ringValues(a, 3).corners, Set{-2});
    EXPECT_EQ(ringValues(a, 3).others, Set{2});

    const Diagram& column = f.q[0];
    const Node e = f.details[0];  // (1,0): its ends are the vertex nodes (0,0) and (2,0)
    EXPECT_EQ(column.size(), 89u);
    EXPECT_EQ(column[e], q("69/71"));
    EXPECT_EQ(column[at(0)], q("-4/71"));
    EXPECT_EQ(column[at(2)], q("-4/71"));
    for (const Node n : {Node{0, 1}, Node{1, 1}, Node{1, -1}, Node{2, -1}}) EXPECT_EQ(column[n], q("-1/568"));
    EXPECT_EQ(column[(Node{0, 2})], q("6/71"));
    EXPECT_EQ(column[(Node{2, -2})], q("6/71"));
}

TEST(Butterfly, WidthFour) {
    const Filters f = construct(namedMask("butterfly"), 4);
    EXPECT_EQ(f.a.size(), 49u);
    EXPECT_EQ(f.a[{}], q("140545/307891"));
    EXPECT_EQ(f.b, construct(namedMask("butterfly"), 0).b) << "B does not change with A";
}

TEST(Loop, WidthsOneAndTwo) {
    const Filters f = construct(namedMask("loop"), 1);
    EXPECT_EQ(f.a, construct(namedMask("loop"), 2).a);
    EXPECT_EQ(f.a[{}], q("5/2"));
    EXPECT_EQ(ringValues(f.a, 1).corners, Set{q("-1/4")});
    EXPECT_EQ(f.q[0], (Diagram{{at(1), 1}, {at(0), q("1/10")}, {at(2), q("1/10")}}));

    // By rings around the edge node, vertex and edge nodes apart.
    const Diagram& b = f.b[0];
    EXPECT_EQ(b.size(), 23u);
    std::map<std::tuple<int, bool, Rational>, int> count;
    for (const auto& [node, value] : b) {
        ++count[{distance(Lattice::Triangular, f.details[0], node), isVertexNode(node), value}];
    }
    const std::map<std::tuple<int, bool, Rational>, int> expected = {
        {{0, false, q("19/16")}, 1}, {{1, false, q("1/8")}, 4},  {{1, true, q("-15/16")}, 2},
        {{2, false, q("1/32")}, 4},  {{2, false, q("3/32")}, 6}, {{2, true, q("-5/16")}, 2},
        {{3, false, q("1/32")}, 4}};
    EXPECT_EQ(count, expected);
}

TEST(Loop, WidthThree) {
    const Filters f = construct(namedMask("loop"), 3);
    EXPECT_EQ(f.a.size(), 37u);
    EXPECT_EQ(f.a[{}], q("605/659"));
    EXPECT_EQ(ringValues(f.a, 1).corners, Set{q("4405/15816")});
}

TEST(LoopLike, FollowsItsFormulasAndContainsLoop) {
    EXPECT_EQ(loopLike(q("1/16"), q("1/8")).p, namedMask("loop").p);
    for (const auto& [alpha, gamma] :
         {std::pair("1/16", "1/8"), {"1/12", "1/10"}, {"1/20", "0"}, {"-1/9", "2/7"}}) {
        const Rational a = q(alpha), g = q(gamma), below = 1 + 2 * g - 12 * a;
        const Filters f = construct(loopLike(a, g), 1);
        EXPECT_EQ(f.a[{}], (1 + 2 * g) / below);
        EXPECT_EQ(ringValues(f.a, 1).corners, Set{-2 * a / below});
        EXPECT_EQ(f.q[0][at(0)], 2 * a / (1 + 2 * g));
        // With gamma = 0 the mask is smaller and width 2 already helps.
        EXPECT_EQ(construct(loopLike(a, g), 2).a == f.a, g != 0);
    }
}

TEST(LoopLike, WithoutALeftInverseIsRefused) {
    // 1 + 2 gamma = 12 alpha: constants times (-1) on a coarse sublattice vanish.
    EXPECT_THAT(complaint([] { construct(loopLike(q("1/8"), q("1/4")), 1); }),
                HasSubstr("loop-like:1/8,1/4: "));
}

TEST(TriangularMask, GivenInSpiralOrderIsRead) {
    // Linear interpolation on triangles: 1, then six halves.
    const Mask mask = customMask(Lattice::Triangular, parseRationals("1 1/2 1/2 1/2 1/2 1/2 1/2"));
    EXPECT_TRUE(interpolates(mask));
    EXPECT_EQ(construct(mask, 0).a, Diagram::delta({}));
    EXPECT_EQ(construct(mask, 1).a, Diagram::delta({}));
    EXPECT_EQ(construct(mask, 2).a.size(), 19u);
}

TEST(TriangularMask, WithADependentColumnIsRefused) {
    // Every fine node takes the sum of ... nothing but its vertex's neighbours: alternating signs vanish.
    const Mask mask = customMask(Lattice::Triangular, parseRationals("0 1 0 0 1 0 0"));
    EXPECT_THAT(complaint([&] { construct(mask, 2); }), HasSubstr("not injective"));
}

// ---- the quad lattice ----

// ---- numbers that no machine word holds ----

Integer largestDenominator(const Diagram& diagram) {
    Integer most = 1;
    for (const auto& [node, value] : diagram) most = std::max(most, Integer(denominator(value)));
    return most;
}

// A P, column by column, without prove(): 1 at the own vertex node, 0 at all others that the row reaches.
bool undoes(const Diagram& a, const Diagram& p, int reach) {
    for (int t = -reach; t <= reach; ++t) {
        if (inner(a, p.shifted(at(2 * t))) != (t == 0 ? 1 : 0)) return false;
    }
    return true;
}

// The denominators of the wide cubic filters pass 2^53 (a double's digits) at 39 taps, 2^59 at 43 and 2^64 at 47: still
// exact, and no longer so as soon as the taps are rounded to doubles.
TEST(ExactArithmetic, HoldsWhereDenominatorsOutgrowDoublesAndSixtyFourBits) {
    const Mask cubic = namedMask("cubic");
    const Integer one = 1;
    for (const auto& [width, bits] : {std::pair(39, 53), {43, 59}, {47, 64}}) {
        const Filters f = construct(cubic, width);
        EXPECT_GT(largestDenominator(f.a), one << bits) << width;
        EXPECT_TRUE(undoes(f.a, cubic.p, width)) << width;
        EXPECT_TRUE(prove(f)) << width;
        Diagram rounded;
        for (const auto& [node, value] : f.a) rounded.add(node, Rational(toDouble(value)));
        EXPECT_FALSE(undoes(rounded, cubic.p, width)) << width;
        Filters wrong = f;
        wrong.a = rounded;
        EXPECT_FALSE(prove(wrong)) << width;
    }
    EXPECT_EQ(largestDenominator(construct(cubic, 47).a), Integer("73275655646637026968"));
}

TEST(CatmullClark, RegularFiltersAreProductsOfTheCubicOnes) {
    const Filters f = construct(namedMask("catmull-clark"), 1);
    EXPECT_EQ(f.a[{}], 4);
    EXPECT_EQ(f.a[at(1)], -1);
    EXPECT_EQ(f.a[(Node{1, 1})], q("1/4"));
    EXPECT_EQ(f.a.size(), 9u);
    const Diagram a7 = construct(namedMask("cubic"), 7).a;
    const Filters wide = construct(namedMask("catmull-clark"), 3);
    for (int x = -3; x <= 3; ++x) {
        for (int y = -3; y <= 3; ++y) EXPECT_EQ((wide.a[Node{x, y}]), a7[at(x)] * a7[at(y)]);
    }
}

TEST(QuadMask, NotAProductAndNotInterpolatingHasAOneTapInverse) {
    // Catmull-Clark's stencils with another vertex rule: no longer a product of two masks.
    Mask mask = namedMask("catmull-clark");
    mask.name = "softer vertex";
    const Rational more = q("1/64");
    mask.p.add({0, 0}, 4 * more);
    for (const Node n : {Node{2, 0}, Node{0, 2}, Node{-2, 0}, Node{0, -2}}) mask.p.add(n, -more);
    const auto a0 = oneTapInverse(mask, 2);
    ASSERT_TRUE(a0);
    EXPECT_TRUE(prove(construct(mask, 3)));
}

}  // namespace
}  // namespace isowave::subdivision
