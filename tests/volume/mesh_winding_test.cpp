#include "volume/mesh_winding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "isowave/error.h"
#include "volume/mesh_checks.h"

namespace isowave {
namespace {

using checks::box, checks::reversed, checks::vectorsOf;
using openvdb::Coord;
using shapes::together;

LatticeLines linesOf(const TriangleMesh& mesh, bool evenOdd = false) {
    return LatticeLines(vectorsOf(mesh), mesh.triangles, evenOdd);
}

// Compares every lattice point of a box with the solid angle; returns how many were inside. Points on the
// surface (solid angle near a half) may be either.
int compareWithSolidAngle(const TriangleMesh& mesh, const openvdb::CoordBBox& where) {
    const LatticeLines lines = linesOf(mesh);
    int inside = 0;
    for (auto point = where.begin(); point; ++point) {
        if (checks::distanceTo(mesh, (*point).asVec3d()) < 1e-9) continue;
        const double winding = checks::windingNumber(mesh, (*point).asVec3d());
        const bool expected = std::round(winding) != 0;
        EXPECT_EQ(lines.inside(*point), expected) << *point << " winding " << winding;
        inside += expected;
    }
    return inside;
}

TEST(LatticeLines, AgreeWithTheSolidAngleOnNestedShells) {
    const openvdb::CoordBBox where(Coord(0), Coord(39));
    const TriangleMesh generic = checks::nestedShells(1, {19.37, 20.11, 18.83});
    EXPECT_GT(compareWithSolidAngle(generic, where), 5000);
}

TEST(LatticeLines, AgreeWithTheSolidAngleWhereCornersLieOnLatticePoints) {
    // Every edge, face and corner of these runs through lattice points: nothing is in general position.
    std::mt19937 random(1);
    std::uniform_int_distribution<int> coordinate(0, 6);
    int solid = 0;
    for (int trial = 0; trial < 200; ++trial) {
        TriangleMesh mesh = shapes::tetrahedron(1);
        for (Point& p : mesh.points) {
            for (double& x : p) x = coordinate(random);
        }
        solid += compareWithSolidAngle(mesh, {Coord(-1), Coord(7)}) > 0;
    }
    EXPECT_GT(solid, 100);  // seen 131: most tetrahedra hold a lattice point
}

TEST(LatticeLines, HoldLowFacesAndNotHighOnes) {
    const LatticeLines lines = linesOf(box({2, 3, 4}, {5, 7, 9}));
    for (auto point = openvdb::CoordBBox(Coord(0), Coord(10)).begin(); point; ++point) {
        const Coord p = *point;
        const bool expected = p.x() >= 2 && p.x() < 5 && p.y() >= 3 && p.y() < 7 && p.z() >= 4 && p.z() < 9;
        EXPECT_EQ(lines.inside(p), expected) << p;
    }
}

TEST(LatticeLines, TakePartsThatOverlapAsOneSolid) {
    const TriangleMesh mesh =
        together(box({0.5, 0.5, 0.5}, {6.5, 6.5, 6.5}), box({3.5, 3.5, 3.5}, {9.5, 9.5, 9.5}));
    const LatticeLines winding = linesOf(mesh), evenOdd = linesOf(mesh, true);
    EXPECT_TRUE(winding.inside(Coord(5)));
    EXPECT_FALSE(evenOdd.inside(Coord(5)));
    for (const LatticeLines* lines : {&winding, &evenOdd}) {
        EXPECT_TRUE(lines->inside(Coord(2)));
        EXPECT_TRUE(lines->inside(Coord(8)));
        EXPECT_FALSE(lines->inside(Coord(8, 2, 2)));
    }
}

TEST(LatticeLines, SayWhetherTheyCrossSurfaceInsideTheSolid) {
    const TriangleMesh one = box({0.5, 0.5, 0.5}, {6.5, 6.5, 6.5});
    EXPECT_FALSE(linesOf(one).hasBuried());
    EXPECT_TRUE(linesOf(together(one, box({3.5, 3.5, 3.5}, {9.5, 9.5, 9.5}))).hasBuried());
    EXPECT_TRUE(linesOf(together(one, box({6.5, 0.5, 0.5}, {9.5, 6.5, 6.5}))).hasBuried());
    EXPECT_FALSE(linesOf(together(one, box({8.5, 0.5, 0.5}, {9.5, 6.5, 6.5}))).hasBuried());
    EXPECT_FALSE(linesOf(together(one, box({0.5, 6.5, 0.5}, {6.5, 9.5, 6.5}))).hasBuried()) << "seen edge-on";
}

TEST(LatticeLines, TakeAMeshTurnedInsideOutAsTheSameSolid) {
    const LatticeLines lines = linesOf(reversed(box({0.5, 0.5, 0.5}, {6.5, 6.5, 6.5})));
    EXPECT_TRUE(lines.inside(Coord(3)));
    EXPECT_FALSE(lines.inside(Coord(7)));
}

TEST(LatticeLines, AnswerEightPointsAsOneByOne) {
    const LatticeLines lines = linesOf(checks::nestedShells(1, {3.37, -20.11, 8.83}));
    int inside = 0;
    for (auto point = openvdb::CoordBBox(Coord(-20, -40, -10), Coord(20, 0, 28)).begin(); point; ++point) {
        const unsigned bits = lines.inside8(*point);
        for (int i = 0; i < 8; ++i) {
            ASSERT_EQ(bits >> i & 1, unsigned(lines.inside((*point).offsetBy(i, 0, 0))))
                << *point << " + " << i;
        }
        inside += bits & 1;
    }
    EXPECT_GT(inside, 5000);
}

TEST(LatticeLines, WorkFarFromTheOrigin) {
    const double at = 3e8;
    const LatticeLines lines = linesOf(box({at + 0.5, -at + 0.5, 0.5}, {at + 4.5, -at + 4.5, 4.5}));
    const auto corner = static_cast<std::int32_t>(at);
    EXPECT_TRUE(lines.inside(Coord(corner + 1, -corner + 1, 1)));
    EXPECT_FALSE(lines.inside(Coord(corner, -corner + 1, 1)));
    EXPECT_TRUE(lines.inside(Coord(corner + 4, -corner + 4, 4)));
    EXPECT_FALSE(lines.inside(Coord(corner + 5, -corner + 4, 4)));
}

TEST(LatticeLines, RefuseAMeshThatIsNotClosed) {
    TriangleMesh mesh = shapes::sphere(10.3, 2);
    EXPECT_NO_THROW(linesOf(mesh));
    mesh.triangles.pop_back();
    EXPECT_THAT([&] { linesOf(mesh); },
                ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("is not closed")));
    EXPECT_THROW(linesOf(mesh, true), InputError);
}

TEST(LatticeLines, RefuseMoreVoxelsThanTheirIntegersHold) {
    EXPECT_NO_THROW(linesOf(box({0.1, 0.1, 0.1}, {2000000.1, 5.1, 5.1})));
    EXPECT_THROW(linesOf(box({0.1, 0.1, 0.1}, {2200000.1, 5.1, 5.1})), InputError);
    EXPECT_THROW(linesOf(box({1e12, 0, 0}, {1e12 + 5, 5, 5})), InputError);
}

TEST(LatticeLines, HoldNothingOfNothing) {
    EXPECT_FALSE(linesOf({}).inside(Coord(0)));
    EXPECT_EQ(linesOf({}).inside8(Coord(0)), 0u);
}

TEST(LatticeLines, DependOnNoThread) {
    const TriangleMesh mesh =
        together(checks::nestedShells(4, {0.1, 0.2, 0.3}), shapes::sphere(12.1, 4, {9, 1, 2}));
    const auto bitsWith = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const LatticeLines lines = linesOf(mesh);
        std::vector<unsigned> bits;
        for (auto p = openvdb::CoordBBox(Coord(-16), Coord(22)).begin(); p; ++p)
            bits.push_back(lines.inside8(*p));
        return bits;
    };
    const auto one = bitsWith(1);
    EXPECT_EQ(one, bitsWith(2));
    EXPECT_EQ(one, bitsWith(4));
}

TEST(LatticeLines, StopWhenAsked) {
    const TriangleMesh mesh = shapes::sphere(10.3, 3);
    Progress progress;
    progress.stopRequested = [] { return true; };
    EXPECT_THROW(LatticeLines(vectorsOf(mesh), mesh.triangles, false, progress), Cancelled);
}

}  // namespace
}  // namespace isowave
