// The promises of volume/fit/fit_mask.h and of its parts.
#include "volume/fit/fit_mask.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <random>

#include "volume/cubic_weights.h"
#include "volume/fit/mask_between.h"
#include "volume/fit/mask_energy.h"
#include "volume/fit/mask_volume.h"
#include "volume/nodes.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;
using namespace fitting;

using Inside = std::function<bool(const Coord&)>;

int squared(const Coord& c) { return c[0] * c[0] + c[1] * c[1] + c[2] * c[2]; }

// ---- the parts, by brute force

TEST(MaskBand, DistancesAreThoseToTheNearestLatticePointOfTheOtherSide) {
    std::vector<zoo::Solid> solids = zoo::thinSolids();
    solids.push_back(zoo::noisySolids()[0]);
    solids.push_back(zoo::cadSolids()[0]);
    for (const zoo::Solid& solid : solids) {
        const auto inside = [&](const Coord& c) { return solid.box.isInside(c) && solid.inside(c); };
        const NodeCollection nodes = nodesFromFunction(solid.inside, solid.box);
        const MaskBand band = bandAround(nodes.grid->constTree());
        std::int64_t points = 0;
        for (std::size_t leaf = 0; leaf < band.leafCount(); ++leaf)
            for (int p = static_cast<int>(leaf % 7); p < 512; p += 7) {  // a sample of them
                const Coord c = band.origins[leaf].offsetBy(p >> 6, p >> 3 & 7, p & 7);
                int square = 25;
                CoordBBox around(c, c);
                around.expand(4);
                for (auto o = around.begin(); o; ++o)
                    if (inside(*o) != inside(c)) square = std::min(square, squared(*o - c));
                const float expected = square <= 20 ? std::sqrt(static_cast<float>(square)) : kBeyondBand;
                ASSERT_EQ(band.distance[leaf][p], inside(c) ? -expected : expected) << solid.name << c;
                points += square <= 20;
            }
        EXPECT_GT(points, 0) << solid.name;
    }
}

TEST(MaskBand, HoldsAllPointsThatAreNear) {
    const zoo::Solid solid = zoo::noisySolids()[0];
    const NodeCollection nodes = nodesFromFunction(solid.inside, solid.box);
    const MaskBand band = bandAround(nodes.grid->constTree());
    CoordBBox box = solid.box;
    box.expand(4);
    for (auto c = box.begin(); c;
         ++c) {  // noise: all of it is near, and so is what lies within 4 along an axis
        const Coord inBox = Coord::minComponent(Coord::maxComponent(*c, solid.box.min()), solid.box.max());
        if (!solid.inside(inBox) || squared(*c - inBox) > kBandSquared) continue;
        const Coord leaf = *c & ~7;
        EXPECT_TRUE(std::binary_search(band.origins.begin(), band.origins.end(), leaf)) << *c;
    }
}

using Block = PaddedLeaf<float, 2, 2>;

// Values at random, `missing` of them none.
Block randomBlock(double missing) {
    std::mt19937 random(7);
    Block block;
    for (float& v : block.values) {
        v = static_cast<float>(random() % 2001) / 100 - 10;
        if (static_cast<double>(random() % 1000) < 1000 * missing) v = kNoValue;
    }
    return block;
}

// The differences that lie within the block, in double.
double energyOf(const Block& block) {
    const auto at = [&](const Coord& c) { return double{block.at(c[0], c[1], c[2])}; };
    const auto unit = [](int axis) { return Coord(axis == 0, axis == 1, axis == 2); };
    const CoordBBox all(Coord(-2), Coord(9));
    double energy = 0;
    for (auto c = all.begin(); c; ++c)
        for (int a = 0; a < 3; ++a) {
            const Coord x = unit(a);
            if (all.isInside(*c - x) && all.isInside(*c + x))
                if (const double q = at(*c + x) - 2 * at(*c) + at(*c - x); !std::isnan(q))
                    energy += q * q / 2;
            for (int b = 0; b < a; ++b)
                if (const Coord y = unit(b); all.isInside(*c + x + y))
                    if (const double q = at(*c) - at(*c + x) - at(*c + y) + at(*c + x + y); !std::isnan(q))
                        energy += q * q;
        }
    return energy;
}

TEST(MaskEnergy, GradientIsThatOfTheSumOfSquares) {
    for (const double missing : {0.0, 0.1, 0.4}) {
        Block block = randomBlock(missing);
        LeafValues gradient;
        gradientOfEnergy(block, gradient);
        for (int p = 0; p < 512; p += 37) {
            float& v = block.values[block.index(p >> 6, p >> 3 & 7, p & 7)];
            if (std::isnan(v)) continue;
            const float before = v;
            v = before + 0.5f;
            const double above = energyOf(block);
            v = before - 0.5f;
            const double below = energyOf(block);
            v = before;
            EXPECT_NEAR(gradient[p], above - below, 1e-2) << p;  // E is a square: exact but for rounding
        }
    }
}

TEST(MaskEnergy, PlanesHaveNoneAndTheLargestEigenvalueIsThatOfAnAlternatingSign) {
    Block plane, alternating;
    for (int x = -2; x < 10; ++x)
        for (int y = -2; y < 10; ++y)
            for (int z = -2; z < 10; ++z) {
                plane.values[plane.index(x, y, z)] = static_cast<float>(3 * x - 2 * y + z);
                alternating.values[plane.index(x, y, z)] = (x + y + z) & 1 ? -1.0f : 1.0f;
            }
    LeafValues gradient;
    gradientOfEnergy(plane, gradient);
    for (const float g : gradient) EXPECT_EQ(g, 0);
    gradientOfEnergy(alternating, gradient);
    EXPECT_EQ(gradient[0], kLargestEigenvalue);
    EXPECT_EQ(gradient[1], -kLargestEigenvalue);
}

TEST(MaskVolume, OfAPlaneIsExact) {
    for (const double offset : {-1.0, 0.0, 0.7}) {
        const Vec3d n = Vec3d(1, 2, 5).unit(), through = Vec3d(3.5) + offset * n;
        Block c;  // a linear function's control points are its values
        LeafValues outside;
        outside.fill(1);
        for (int x = -2; x < 10; ++x)
            for (int y = -2; y < 10; ++y)
                for (int z = -2; z < 10; ++z)
                    c.values[c.index(x, y, z)] = static_cast<float>((Vec3d(x, y, z) - through).dot(n));
        BlockShare sum;
        for (const BlockShare& share : sharesOf(c, outside))
            sum.missing += share.missing, sum.area += share.area;
        double volume = 0;
        constexpr int kFine = 64;
        for (int x = 0; x < kFine; ++x)
            for (int y = 0; y < kFine; ++y)
                for (int z = 0; z < kFine; ++z)
                    volume +=
                        (Vec3d(x + 0.5, y + 0.5, z + 0.5) * 8.0 / kFine - Vec3d(0.5) - through).dot(n) < 0;
        volume *= std::pow(8.0 / kFine, 3);
        EXPECT_NEAR(-sum.missing, volume, 0.005 * 512) << offset;
        EXPECT_NEAR(sum.area, 64 / n[2], 0.1 * 64 / n[2]) << offset;
    }
}

// F from control points by cubicWeights(), corners one by one.
TEST(MaskBetween, TellsWhatMiddlesOfAgreeingCornersLack) {
    constexpr float kFloor = 0.1f, kTarget = 0.3f;
    std::mt19937 random(5);
    std::uniform_real_distribution<float> noise(-1, 1);
    Block c, D;
    for (float& v : c.values) v = noise(random);
    for (float& v : D.values) v = noise(random) < 0.3f ? -1.0f : 1.0f;
    LeafValues lacking;
    lackingBetween(c, D, kFloor, kTarget, lacking);
    const auto valueAt = [&](const Vec3d& x) {
        double sum = 0;
        const Coord low = Coord::floor(x);
        for (int i = -1; i < 3; ++i)
            for (int j = -1; j < 3; ++j)
                for (int k = -1; k < 3; ++k) {
                    const Coord p = low.offsetBy(i, j, k);
                    double w = 1;
                    for (int a = 0; a < 3; ++a) w *= cubicWeights(x[a] - low[a])[p[a] - low[a] + 1];
                    if (w != 0) sum += w * c.at(p[0], p[1], p[2]);
                }
        return sum;
    };
    int places = 0;
    for (int p = 0; p < 512; ++p) {
        const Coord corner(p >> 6, p >> 3 & 7, p & 7);
        const double s = D.at(corner[0], corner[1], corner[2]) < 0 ? -1 : 1;
        double most = 0;
        for (int n = 0; n < 27; ++n) {
            const Coord way(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
            bool agree = n != 13;
            for (int k = 0; k < 8; ++k) {
                const Coord other =
                    corner.offsetBy(k & 1 ? way[0] : 0, k & 2 ? way[1] : 0, k & 4 ? way[2] : 0);
                agree = agree && (D.at(other[0], other[1], other[2]) < 0) == (s < 0);
            }
            const double sF = s * valueAt(corner.asVec3d() + way.asVec3d() / 2);
            if (agree && sF < kFloor) most = std::max(most, kTarget - sF);
        }
        ASSERT_NEAR(lacking[p], most, 1e-5) << corner;
        places += most > 0;
    }
    EXPECT_GT(places, 200);
    EXPECT_LT(places, 512);
}

// ---- the fit

BSplineField fitted(const Inside& inside, const CoordBBox& box, FitReport* report = nullptr) {
    return fitMask(nodesFromFunction(inside, box), {}, report);
}

TEST(FitMask, SignsAgreeAtEveryLatticePointOfTheWholeZoo) {
    for (const auto& solid : zoo::allSolids()) {
        FitReport report;
        const BSplineField field = fitted(solid.inside, solid.box, &report);
        EXPECT_EQ(report.disagreeing, 0) << solid.name;
        EXPECT_EQ(report.repaired, 0) << solid.name << ": the repair has nothing to do";
        EXPECT_EQ(report.gradientPasses, 60);
        CoordBBox box = solid.box;
        box.expand(5);
        const Vec3d shift = field.transform().worldToIndex(Vec3d(0));
        for (auto c = box.begin(); c; ++c) {
            const bool inside = solid.box.isInside(*c) && solid.inside(*c);
            ASSERT_EQ(evaluate(field, shift + (*c).asVec3d()) < 0, inside) << solid.name << *c;
        }
    }
}

// Two slabs of 40 x 40 with one voxel between them were joined at their corners, four of them.
TEST(FitMask, SignsAgreeBetweenLatticePointsThatDo) {
    std::vector<zoo::Solid> solids = zoo::thinSolids();
    for (const int thick : {1, 3, 14})
        solids.push_back({"slabs " + std::to_string(thick),
                          [thick](const Coord& c) { return c[2] != thick; },
                          CoordBBox(Coord(0), Coord(39, 39, 2 * thick)),
                          {}});
    solids.push_back(zoo::noisySolids()[0]);
    for (const zoo::Solid& solid : solids) {
        const BSplineField field = fitted(solid.inside, solid.box);
        const auto inside = [&](const Coord& c) { return solid.box.isInside(c) && solid.inside(c); };
        const Vec3d shift = field.transform().worldToIndex(Vec3d(0));
        CoordBBox box = solid.box;
        box.expand(1);
        std::int64_t wrong = 0;
        for (auto low = box.begin(); low; ++low)
            for (int way = 1; way < 8; ++way) {
                const Coord end = (*low).offsetBy(way & 1, way >> 1 & 1, way >> 2);
                bool agree = true;
                for (auto c = CoordBBox(*low, end).begin(); c; ++c)
                    agree = agree && inside(*c) == inside(*low);
                const Vec3d middle = ((*low).asVec3d() + end.asVec3d()) / 2;
                wrong += agree && (evaluate(field, shift + middle) < 0) != inside(*low);
            }
        EXPECT_EQ(wrong, 0) << solid.name;
    }
}

TEST(FitMask, HasTheControlPointsOfTheBinaryFit) {
    for (const auto& solid : zoo::allSolids())
        EXPECT_TRUE(fitted(solid.inside, solid.box)
                        .controlPoints->tree()
                        .hasSameTopology(zoo::binaryField(solid).controlPoints->tree()))
            << solid.name;
}

TEST(FitMask, IsTheSameForAnyNumberOfThreads) {
    for (const auto& solid : {zoo::cadSolids()[1], zoo::noisySolids()[0]}) {
        std::vector<BSplineField> fields;
        for (const int threads : {1, 2, 4}) {
            tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            fields.push_back(fitted(solid.inside, solid.box));
        }
        for (const auto& field : fields)
            for (auto c = field.controlPoints->cbeginValueAll(); c; ++c)
                ASSERT_EQ(*c, fields[0].controlPoints->tree().getValue(c.getCoord())) << solid.name;
    }
}

// The volume where F < 0, in voxels, F a plane in each of 4^3 cells of a voxel; and the rms angle between F's
// gradient and the truth's at samples within a tenth of a voxel of the zero set.
struct Seen {
    double volume = 0, degrees = 0;
};
Seen seen(const BSplineField& field, const CoordBBox& box, const std::function<Vec3d(const Vec3d&)>& normal,
          const Vec3d& spacing = Vec3d(1)) {
    Seen result;
    double angles = 0;
    std::int64_t count = 0;
    const Vec3d shift = field.transform().worldToIndex(Vec3d(0));
    for (auto c = box.begin(); c; ++c)
        for (int i = 0; i < 64; ++i) {
            const Vec3d p = (*c).asVec3d() + Vec3d(i >> 4, i >> 2 & 3, i & 3) / 4.0 - Vec3d(0.375);
            const double F = evaluate(field, shift + p);
            if (std::abs(F) > 0.1) {
                result.volume += F < 0 ? 1.0 / 64 : 0;
                continue;
            }
            const Vec3d gradient = evaluateGradient(field, shift + p);
            result.volume += std::clamp(0.5 - 4 * F / gradient.length(), 0.0, 1.0) / 64;
            if (!normal || std::abs(F) > 0.025) continue;
            const double cosine = std::clamp((gradient / spacing).unit().dot(normal(p * spacing)), -1.0, 1.0);
            angles += std::pow(std::acos(cosine) * 180 / std::numbers::pi, 2);
            ++count;
        }
    if (count > 0) result.degrees = std::sqrt(angles / static_cast<double>(count));
    return result;
}

std::int64_t voxelsOf(const Inside& inside, const CoordBBox& box) {
    std::int64_t count = 0;
    for (auto c = box.begin(); c; ++c) count += inside(*c);
    return count;
}

TEST(FitMask, BallsKeepTheVolumeOfTheirVoxelsAndHaveSmoothNormals) {
    const Vec3d o(0.137, -0.231, 0.342);
    struct Row {
        double radius, volume, degrees;
    };
    // seen: -0.0021 2.5, 0.0008 2.3, 0.0007 1.9; marching cubes: -0.055, -0.019, -0.005 and 23 degrees
    for (const Row& row : {Row{3, 0.01, 5}, {5, 0.005, 4}, {10, 0.002, 3}}) {
        const int half = static_cast<int>(row.radius) + 3;
        const CoordBBox box{Coord(-half), Coord(half)};
        const Inside inside = [&](const Coord& c) { return (c.asVec3d() - o).length() < row.radius; };
        const Seen found = seen(fitted(inside, box), box, [&](const Vec3d& p) { return (p - o).unit(); });
        const auto voxels = static_cast<double>(voxelsOf(inside, box));
        std::printf("ball %g: volume %+.4f, normals %.1f degrees\n", row.radius, found.volume / voxels - 1,
                    found.degrees);
        EXPECT_NEAR(found.volume / voxels, 1, row.volume) << row.radius;
        EXPECT_LT(found.degrees, row.degrees) << row.radius;
    }
}

TEST(FitMask, ThinSheetsShellsAndRodsKeepTheirVolume) {
    struct Row {
        const char* name;
        Inside inside;
        double allowed;
    };
    const Row rows[] = {
        {"sheet", [](const Coord& c) { return c[2] == 0 && std::abs(c[0]) < 12 && std::abs(c[1]) < 12; },
         0.03},
        {"shell", [](const Coord& c) { return std::abs(c.asVec3d().length() - 10) < 0.5; }, 0.03},
        {"rod", [](const Coord& c) { return std::hypot(c[0], c[1]) < 1.5 && std::abs(c[2]) < 13; }, 0.02},
        {"cube", [](const Coord& c) { return Coord::lessThan(Coord(-9), c) && Coord::lessThan(c, Coord(8)); },
         0.01}};
    const CoordBBox box{Coord(-15), Coord(15)};
    for (const Row& row : rows) {
        const auto voxels = static_cast<double>(voxelsOf(row.inside, box));
        const double volume = seen(fitted(row.inside, box), box, {}).volume;
        std::printf("%s: volume %+.4f\n", row.name, volume / voxels - 1);
        EXPECT_NEAR(volume / voxels, 1, row.allowed) << row.name;
    }
}

TEST(FitMask, VolumesDoNotDependOnWhereBlocksBegin) {
    for (const int at : {0, 1, 4}) {
        const CoordBBox cube(Coord(at), Coord(at + 15));
        CoordBBox box = cube;
        box.expand(2);
        const double volume =
            seen(fitted([&](const Coord& c) { return cube.isInside(c); }, box), box, {}).volume;
        EXPECT_NEAR(volume / 4096, 1, 0.006) << at;
    }
}

TEST(FitMask, VoxelsThreeTimesAsHighKeepVolumeAndNormals) {
    // A ball of 24 mm in voxels of 1 x 1 x 3 mm.
    const Vec3d spacing(1, 1, 3), o(0.3, -0.2, 0.4);
    const CoordBBox box(-27, -27, -11, 27, 27, 11);
    const Inside inside = [&](const Coord& c) { return (c.asVec3d() * spacing - o).length() < 24; };
    const Seen found = seen(
        fitted(inside, box), box, [&](const Vec3d& p) { return (p - o).unit(); }, spacing);
    std::printf("1 x 1 x 3: volume %+.4f, normals %.1f degrees\n",
                found.volume / static_cast<double>(voxelsOf(inside, box)) - 1, found.degrees);
    EXPECT_NEAR(found.volume / static_cast<double>(voxelsOf(inside, box)), 1, 0.002);
    EXPECT_LT(found.degrees, 7);
}

TEST(FitMask, NothingIsAnEmptyFieldAndOneVoxelIsASmallBall) {
    const CoordBBox box(Coord(-3), Coord(3));
    FitReport report;
    EXPECT_EQ(fitted([](const Coord&) { return false; }, box, &report).controlPointCount(), 0);
    EXPECT_EQ(report.disagreeing, 0);
    const double volume = seen(fitted([](const Coord& c) { return c == Coord(0); }, box), box, {}).volume;
    EXPECT_NEAR(volume, 1, 0.25);  // seen 1.21
}

}  // namespace
}  // namespace isowave
