#include "hold/cut_or_fill.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "hold/mesh_lattice.h"
#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using testing::fieldFromDistance;
using testing::noiseField;
using testing::sphere;
using testing::torus;
using Kind = TopologyEdit::Kind;
using What = TopologyEdit::What;

constexpr double kPi = std::numbers::pi;

auto plateWithHoles(int n, double radius, double apart, double halfThick) {
    return [=](const Vec3d& x) {
        const double half = n * apart / 2;
        double d = std::max({std::abs(x[0]) - half, std::abs(x[1]) - half, std::abs(x[2]) - halfThick});
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                d = std::max(
                    d, radius - std::hypot(x[0] + half - (i + 0.5) * apart, x[1] + half - (j + 0.5) * apart));
        return d;
    };
}

auto gyroid(double period, double half, double reach) {
    return [=](const Vec3d& p) {
        const Vec3d x = p * (2 * kPi / period);
        const double g = std::sin(x[0]) * std::cos(x[1]) + std::sin(x[1]) * std::cos(x[2]) +
                         std::sin(x[2]) * std::cos(x[0]);
        return std::max(std::abs(g) * period / (2 * kPi) / 1.5 - half, p.length() - reach);
    };
}

BSplineField copyOf(const BSplineField& field) {
    BSplineField copy = field;
    copy.controlPoints = field.controlPoints->deepCopy();
    copy.shape = field.shape->deepCopy();
    return copy;
}

bool sameBits(const BSplineField& a, const BSplineField& b) {
    if (!a.controlPoints->tree().hasSameTopology(b.controlPoints->tree())) return false;
    for (auto v = a.controlPoints->cbeginValueAll(); v; ++v)
        if (b.controlPoints->tree().getValue(v.getCoord()) != *v) return false;
    for (auto v = a.shape->cbeginValueAll(); v; ++v)
        if (b.shape->tree().getValue(v.getCoord()) != *v) return false;
    return true;
}

double volumeOf(const BSplineField& field, int refine) {
    return topologyOf(polygonize(field, {.refine = refine})).volume;
}

TEST(CutOrFill, CutsAThinRingAndFillsASmallHole) {
    for (const int refine : {1, 2}) {
        BSplineField thin = fieldFromDistance(16, torus(5, 2)), thick = fieldFromDistance(16, torus(5, 3.4));
        const TopologyEdits cut = limitTopology(thin, refine, {.handles = 0}, 0);
        EXPECT_TRUE(cut.met) << cut.why;
        ASSERT_EQ(cut.edits.size(), 1u);
        EXPECT_EQ(cut.edits[0].kind, Kind::cut);
        EXPECT_EQ(cut.after, (SolidCounts{1, 0, 0}));
        EXPECT_NEAR(cut.edits[0].at.length(), 5, 1.5);  // in the ring
        // A gap of one or two control points across a disc of radius 2; seen 26, 22.
        EXPECT_LT(-cut.edits[0].volume, 2.2 * kPi * 4);
        EXPECT_GT(-cut.edits[0].volume, 0.2 * kPi * 4);
        const TopologyEdits fill = limitTopology(thick, refine, {.handles = 0}, 0);
        EXPECT_TRUE(fill.met) << fill.why;
        ASSERT_EQ(fill.edits.size(), 1u);
        EXPECT_EQ(fill.edits[0].kind, Kind::fill);
        EXPECT_LT(fill.edits[0].at.length(), 2);  // in the hole
        EXPECT_LT(fill.edits[0].volume, 2.5 * kPi * 1.6 * 1.6);
        EXPECT_GT(fill.edits[0].volume, 0.2 * kPi * 1.6 * 1.6);
    }
}

TEST(CutOrFill, ReportsTheVolumeOfTheMesh) {
    BSplineField field = fieldFromDistance(16, torus(5, 3.4));
    const double before = volumeOf(field, 2);
    const TopologyEdits edits = limitTopology(field, 2, {.handles = 0}, 0);
    ASSERT_EQ(edits.edits.size(), 1u);
    EXPECT_NEAR(volumeOf(field, 2) - before, edits.edits[0].volume, 1e-3 * before);
    EXPECT_EQ(edits.after, meshedCounts(field, 2, 0));
}

TEST(CutOrFill, JoinsTwoBallsThatAreNearAndRemovesOneThatIsFar) {
    const auto balls = [](double second, double at) {
        return fieldFromDistance(16, [=](const Vec3d& x) {
            return std::min(sphere(5, {-4, 0.2, 0.1})(x), sphere(second, {at, 0.2, 0.1})(x));
        });
    };
    BSplineField near = balls(4, 6.5), far = balls(1.6, 10);
    const TopologyEdits joined = limitTopology(near, 1, {.parts = 1}, 0);
    EXPECT_EQ(joined.before, (SolidCounts{2, 0, 0}));
    EXPECT_EQ(joined.after, (SolidCounts{1, 0, 0}));
    ASSERT_EQ(joined.edits.size(), 1u);
    EXPECT_EQ(joined.edits[0].kind, Kind::fill);
    EXPECT_LT(joined.edits[0].volume, 8);
    const TopologyEdits removed = limitTopology(far, 1, {.parts = 1}, 0);
    EXPECT_EQ(removed.after, (SolidCounts{1, 0, 0}));
    ASSERT_EQ(removed.edits.size(), 1u);
    const double ball = 4 * kPi / 3 * std::pow(1.6, 3);
    EXPECT_LT(std::abs(removed.edits[0].volume), 1.1 * ball);
    if (removed.edits[0].kind == Kind::cut) {
        EXPECT_GT(-removed.edits[0].volume, 0.8 * ball);
    }
}

TEST(CutOrFill, FillsACavity) {
    BSplineField field =
        fieldFromDistance(16, [](const Vec3d& x) { return std::max(sphere(9)(x), -sphere(1.7)(x)); });
    const TopologyEdits edits = limitTopology(field, 1, {.cavities = 0}, 0);
    EXPECT_EQ(edits.before, (SolidCounts{1, 0, 1}));
    EXPECT_EQ(edits.after, (SolidCounts{1, 0, 0}));
    ASSERT_EQ(edits.edits.size(), 1u);
    EXPECT_EQ(edits.edits[0].what, What::cavity);
    EXPECT_LT(std::abs(edits.edits[0].volume), 4 * kPi / 3 * std::pow(1.9, 3));
}

TEST(CutOrFill, OpensACavityInWhoseMiddleFIsFarBeyondK) {
    BSplineField field =
        fieldFromDistance(16, [](const Vec3d& x) { return std::max(sphere(9)(x), -sphere(7.5)(x)); });
    auto values = field.controlPoints->getAccessor();  // as holding what is thin may leave them
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) values.setValue(Coord(x, y, z), static_cast<float>(5 * field.K));
    const TopologyEdits edits = limitTopology(field, 1, {.cavities = 0}, 0);
    EXPECT_EQ(edits.before, (SolidCounts{1, 0, 1}));
    EXPECT_EQ(edits.after, (SolidCounts{1, 0, 0})) << edits.why;
    ASSERT_EQ(edits.edits.size(), 1u);
    EXPECT_EQ(edits.edits[0].kind, Kind::cut) << "less than to fill it";
}

TEST(CutOrFill, LeavesTenOfThirtySixHoles) {
    BSplineField field = fieldFromDistance(28, plateWithHoles(6, 2.2, 8, 2));
    const TopologyEdits edits = limitTopology(field, 1, {.handles = 10}, 0);
    EXPECT_EQ(edits.before, (SolidCounts{1, 36, 0}));
    EXPECT_EQ(edits.after, (SolidCounts{1, 10, 0}));
    EXPECT_TRUE(edits.met);
    EXPECT_EQ(edits.edits.size(), 26u);
    for (const TopologyEdit& edit : edits.edits) EXPECT_LT(std::abs(edit.volume), 2.2 * kPi * 2.2 * 2.2);
}

TEST(CutOrFill, LimitsAGyroid) {
    BSplineField field = fieldFromDistance(14, gyroid(12, 1.1, 11));
    const SolidCounts before = meshedCounts(field, 1, 1);
    EXPECT_GT(before.handles, 5);
    const std::int64_t most = before.handles / 2;
    const TopologyEdits edits = limitTopology(field, 1, {.handles = most}, 1);
    EXPECT_TRUE(edits.met) << edits.why;
    EXPECT_EQ(edits.after.handles, most);
    EXPECT_LE(edits.after.parts, before.parts);
    EXPECT_LE(edits.after.cavities, before.cavities);
}

TEST(CutOrFill, ChangesNothingWithinTheLimits) {
    BSplineField field = fieldFromDistance(16, torus(8, 3));
    const auto* grid = field.controlPoints.get();
    const BSplineField before = copyOf(field);
    const TopologyEdits edits = limitTopology(field, 1, {.parts = 1, .handles = 1, .cavities = 0}, 0);
    EXPECT_TRUE(edits.met);
    EXPECT_TRUE(edits.edits.empty());
    EXPECT_EQ(field.controlPoints.get(), grid);
    EXPECT_TRUE(sameBits(field, before));
}

TEST(CutOrFill, LeavesGridsThatOthersShare) {
    BSplineField field = fieldFromDistance(16, torus(5, 2));
    const BSplineField shared = field, before = copyOf(field);
    limitTopology(field, 1, {.handles = 0}, 0);
    EXPECT_FALSE(sameBits(field, before));
    EXPECT_TRUE(sameBits(shared, before));
}

// The hardest fields: whatever was reached is what is counted, and nothing else has risen.
TEST(CutOrFill, IsHonestAboutEveryField) {
    std::vector<zoo::NamedField> fields = zoo::allFields();
    for (unsigned seed = 0; seed < 3; ++seed) fields.push_back({"noise", noiseField(10, seed)});
    int met = 0, limited = 0;
    for (zoo::NamedField& f : fields) {
        const SolidCounts counts = meshedCounts(f.field, 1, 0);
        if (counts.parts > 100 || counts.handles > 100) continue;
        const SolidLimits limits{counts.parts > 0 ? std::int64_t(1) : 0, counts.handles / 2, {}};
        const TopologyEdits edits = limitTopology(f.field, 1, limits, 0);
        EXPECT_EQ(edits.after, meshedCounts(f.field, 1, 0)) << f.name;
        EXPECT_EQ(edits.met, limits.allow(edits.after)) << f.name;
        EXPECT_EQ(edits.met, edits.why.empty()) << f.name;
        EXPECT_LE(edits.after.cavities, edits.before.cavities) << f.name;
        EXPECT_LE(edits.after.parts, edits.before.parts) << f.name;
        EXPECT_LE(edits.after.handles, edits.before.handles) << f.name;
        met += edits.met;
        ++limited;
    }
    EXPECT_GE(met, limited * 3 / 4) << limited;
}

// Of every field of the zoo: fills activate control points, and signs change.
TEST(CutOrFill, KeepsTheFieldsInvariants) {
    BSplineField field = zoo::binaryField(zoo::cadSolids().front());
    const std::int64_t handles = meshedCounts(field, 1, 0).handles;
    ASSERT_GT(handles, 0);
    const TopologyEdits edits = limitTopology(field, 1, {.handles = 0}, 0);
    EXPECT_TRUE(edits.met) << edits.why;
    EXPECT_TRUE(field.shape->tree().hasSameTopology(field.controlPoints->tree()));
    const auto values = field.controlPoints->getConstAccessor();
    const auto shape = field.shape->getConstAccessor();
    for (auto v = field.controlPoints->cbeginValueOn(); v; ++v) {
        const Coord at = v.getCoord();
        EXPECT_EQ(shape.getValue(at), evaluate(field, at.asVec3d()) < 0) << at;
        // In a block of four on each axis that is known.
        bool inBlock = false;
        for (int k = 0; k < 64 && !inBlock; ++k) {
            const Coord low = at.offsetBy(-(k >> 4), -(k >> 2 & 3), -(k & 3));
            inBlock = true;
            const openvdb::CoordBBox block(low, low.offsetBy(3));
            for (auto c = block.begin(); c && inBlock; ++c) inBlock = values.isValueOn(*c);
        }
        EXPECT_TRUE(inBlock) << at;
    }
}

TEST(CutOrFill, DoesNotDependOnThreads) {
    std::vector<BSplineField> fields;
    for (const int threads : {1, 4}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        fields.push_back(fieldFromDistance(14, gyroid(12, 1.1, 11)));
        limitTopology(fields.back(), 1, {.handles = 3}, 1);
    }
    EXPECT_TRUE(sameBits(fields[0], fields[1]));
}

// The lattice on which rings and holes are found sees what the mesh sees.
TEST(DecidedLattice, HasTheTopologyOfTheMesh) {
    for (const zoo::NamedField& f : zoo::allFields()) {
        if (f.name.find("noise") != std::string::npos || f.name.find("checkerboard") != std::string::npos)
            continue;
        const MeshLattice lattice = decidedLattice(f.field, 1);
        std::array<std::int64_t, 3> found{};
        for (const PersistentClass& c : classesAt(lattice.function, -1e-45f, 0)) ++found[c.dimension];
        EXPECT_EQ((SolidCounts{found[0], found[1], found[2]}), meshedCounts(f.field, 1, 0)) << f.name;
    }
}

TEST(MeshLattice, IsNoLargerThanTheSolid) {
    const double points = latticePoints(fieldFromDistance(16, sphere(5)), 1);
    EXPECT_GE(points, std::pow(2 * 5 + 1, 3));
    EXPECT_LE(points, std::pow(2 * 5 + 1 + 2 * 4, 3)) << "the leaves' box has 32^3";
}

TEST(MeshLattice, HoldsTheSplineAtLatticePointsAndBetween) {
    const BSplineField field = fieldFromDistance(8, torus(5, 2));
    const MeshLattice lattice = meshLattice(field, 2);
    const LatticeFunction halfway = halfwayValues(field, Coord(-4), Coord(9));
    for (const Coord& c : {Coord(0), Coord(3, -5, 7), Coord(8, 1, -2)}) {
        const double f = evaluate(field, c.asVec3d() / 2);
        EXPECT_NEAR(lattice.at(c), f, 1e-5);
        const Coord p = c + Coord(8);
        EXPECT_NEAR(halfway.values[halfway.index(p[0], p[1], p[2])], f, 1e-5);
    }
}

}  // namespace
}  // namespace isowave
