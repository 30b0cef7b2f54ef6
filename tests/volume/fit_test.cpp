// The promises of volume/fit.h, nodes and distances.
#include "volume/fit.h"
#include "volume/linear_transform.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "isowave/error.h"
#include "volume/distance.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

// ---- signs

TEST(Fit, SignsAgreeWithTheInputAtEveryLatticePointOfTheWholeZoo) {
    for (const auto& solid : zoo::allSolids()) {
        FitReport report;
        fitBinary(nodesFromFunction(solid.inside, solid.box), {}, &report);
        EXPECT_EQ(report.disagreeing, 0) << solid.name;
        if (!solid.distance) continue;
        fitDistance(*distanceFromFunction(solid.distance, solid.box, 4), {}, &report);
        EXPECT_EQ(report.disagreeing, 0) << solid.name;
        EXPECT_GT(report.latticePoints, 0);
    }
}

TEST(Fit, TheReportedAgreementIsWhatABruteForceEvaluationFinds) {
    for (const auto& solid : zoo::allSolids()) {
        const BSplineField field = zoo::binaryField(solid);
        CoordBBox box = solid.box;
        box.expand(4);
        for (auto c = box.begin(); c; ++c) {
            const bool inside = solid.box.isInside(*c) && solid.inside(*c);
            const Vec3d x = field.transform().worldToIndex((*c).asVec3d());
            ASSERT_EQ(evaluate(field, x) < 0, inside) << solid.name << *c;
        }
    }
}

TEST(Fit, FilteringAloneLosesAOneVoxelWallAndTheRepairBringsItBack) {
    // An endless wall, one voxel thick: the filter acts across it alone, c <- (c + (4c + left + right)/6)/2.
    std::vector<double> c(17, 1.0);
    c[8] = -1;
    for (int pass = 0; pass < 4; ++pass) {
        std::vector<double> next = c;
        for (std::size_t i = 1; i + 1 < c.size(); ++i)
            next[i] = 0.5 * (c[i] + (4 * c[i] + c[i - 1] + c[i + 1]) / 6);
        c = next;
    }
    EXPECT_GT((c[7] + 4 * c[8] + c[9]) / 6, 0) << "the wall should be gone";

    const auto wall = zoo::thinSolids()[1];
    FitReport report;
    fitBinary(nodesFromFunction(wall.inside, wall.box), {.passes = 4}, &report);
    EXPECT_EQ(report.filterPasses, 4);
    EXPECT_GT(report.repaired, 0);
    EXPECT_EQ(report.disagreeing, 0);
    EXPECT_LE(report.repairPasses, 20);  // seen 5
}

TEST(Fit, WhiteNoiseIsRepairedInFewPasses) {
    const auto noise = zoo::noisySolids()[0];
    FitReport report;
    fitBinary(nodesFromFunction(noise.inside, noise.box), {}, &report);
    EXPECT_EQ(report.disagreeing, 0);
    EXPECT_LE(report.repairPasses, 40);  // seen 16
}

TEST(Fit, SaysWhetherTheRepairStoppedByAgreementOrAtItsLimit) {
    const auto noise = zoo::noisySolids()[0];
    const NodeCollection nodes = nodesFromFunction(noise.inside, noise.box);
    FitReport whole, cut;
    fitBinary(nodes, {}, &whole);
    EXPECT_TRUE(whole.repairAgreed);
    EXPECT_EQ(whole.repairFloor, 0.05);
    fitBinary(nodes, {.mostRepairPasses = 2}, &cut);
    EXPECT_FALSE(cut.repairAgreed);
    EXPECT_EQ(cut.repairPasses, 2);
    EXPECT_GT(cut.disagreeing, 0);
    // One pass more finds that nothing is left to do.
    fitBinary(nodes, {.mostRepairPasses = whole.repairPasses + 1}, &cut);
    EXPECT_TRUE(cut.repairAgreed);

    const auto ball = zoo::smoothSolids()[0];
    fitDistance(*distanceFromFunction(ball.distance, ball.box, 4), {}, &whole);
    EXPECT_TRUE(whole.repairAgreed);
    EXPECT_EQ(whole.repairFloor, 1e-4 / 4);
}

TEST(Fit, KnownPointsAreTheNodesDilatedByMinusOneToTwo) {
    const auto voxel = zoo::thinSolids()[0];  // lattice point (3,-2,7): nodes 2..3, -3..-2, 6..7
    const BSplineField field = zoo::binaryField(voxel);
    EXPECT_EQ(field.controlPointCount(), 5 * 5 * 5);
    const CoordBBox expected(1, -4, 5, 5, 0, 9);
    for (auto c = field.controlPoints->cbeginValueOn(); c; ++c)
        EXPECT_TRUE(expected.isInside(Coord::round(field.transform().indexToWorld(c.getCoord()))));
    EXPECT_EQ(definedNodeCount(field), 2 * 2 * 2);
}

TEST(Fit, NoControlPointLiesBelowMinusOne) {
    for (const auto& [name, field] : zoo::allFields())
        for (auto c = field.controlPoints->cbeginValueOn(); c; ++c)
            for (int a = 0; a < 3; ++a) ASSERT_GE(c.getCoord()[a], -1) << name;
}

TEST(Fit, AnEmptySolidIsAnEmptyField) {
    const BSplineField field = zoo::binaryField(zoo::emptySolids()[0]);
    EXPECT_EQ(field.controlPointCount(), 0);
    EXPECT_NEAR(evaluate(field, Vec3d(1, 2, 3)), 1.0, 1e-15);
}

TEST(Fit, RefusesASolidThatIsNotFinite) {
    EXPECT_THROW(fitDistance(openvdb::FloatGrid(-4.0f)), InputError);
    EXPECT_THROW(nodesFromSigns(openvdb::BoolGrid(true)), InputError);
}

TEST(Fit, TheDeepInsideIsMinusKAndCostsNothing) {
    const CoordBBox box(0, 0, 0, 299, 299, 299);
    const BSplineField field = fitBinary(nodesFromFunction([](const Coord&) { return true; }, box));
    EXPECT_NEAR(evaluate(field, Vec3d(150, 150, 150)), -1.0, 1e-15);
    EXPECT_NEAR(evaluate(field, Vec3d(-40, 150, 150)), 1.0, 1e-15);
    EXPECT_LT(field.controlPoints->memUsage(), 60u << 20);  // seen 29 MB; a dense grid is 108 MB
}

TEST(Fit, FieldsAreTheSameForAnyNumberOfThreads) {
    const auto solid = zoo::cadSolids()[1];
    std::vector<BSplineField> fields;
    for (const int threads : {1, 2, 4}) {
        tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        fields.push_back(zoo::distanceField(solid));
    }
    for (const auto& field : fields) {
        ASSERT_TRUE(field.controlPoints->tree().hasSameTopology(fields[0].controlPoints->tree()));
        for (auto c = field.controlPoints->cbeginValueAll(); c; ++c)
            ASSERT_EQ(*c, fields[0].controlPoints->tree().getValue(c.getCoord()));
    }
}

// ---- accuracy

// Rms distance, in voxels, of the field's zero set to the true surface: the true distance at the roots along
// lattice edges, found by bisection on the spline itself.
double rmsOfZeroSet(const BSplineField& field, const std::function<double(const Vec3d&)>& truth) {
    double sum = 0;
    std::int64_t count = 0;
    const auto inside = field.shape->getConstAccessor();
    for (auto node = field.shape->cbeginValueOn(); node; ++node)
        for (int axis = 0; axis < 3; ++axis) {
            Coord next = node.getCoord();
            next[axis] += 1;
            if (inside.getValue(node.getCoord()) == inside.getValue(next)) continue;
            double low = 0, high = 1;
            const auto at = [&](double t) {
                Vec3d x = node.getCoord().asVec3d();
                x[axis] += t;
                return x;
            };
            const bool lowInside = evaluate(field, at(0)) < 0;
            for (int i = 0; i < 40; ++i) {
                const double middle = 0.5 * (low + high);
                ((evaluate(field, at(middle)) < 0) == lowInside ? low : high) = middle;
            }
            const double d = truth(field.transform().indexToWorld(at(low)));
            sum += d * d;
            ++count;
        }
    return std::sqrt(sum / static_cast<double>(count));
}

struct Ladder {
    const char* name;
    std::function<double(const Vec3d&)> distance;  // at unit scale
    double half;                                   // half of the box at unit scale
    bool smooth;
};

std::vector<Ladder> ladders() {
    const Vec3d centre(0.031, -0.027, 0.013);
    return {{"sphere", [centre](const Vec3d& p) { return (p - centre).length() - 1; }, 1.7, true},
            {"torus",
             [centre](const Vec3d& p) {
                 const Vec3d q = p - centre;
                 return std::hypot(std::hypot(q.x(), q.y()) - 1.5, q.z()) - 0.8;
             },
             3.0, true},
            {"perforated cylinder",
             [centre](const Vec3d& p) {
                 const Vec3d q = p - centre;
                 const double wall = std::hypot(q.x(), q.y()) - 1.5, ends = std::abs(q.z()) - 1.2;
                 const double outer = std::min(std::max(wall, ends), 0.0) +
                                      std::hypot(std::max(wall, 0.0), std::max(ends, 0.0));
                 return std::max({outer, 0.5 - std::hypot(q.x(), q.y()), 0.3 - std::hypot(q.y(), q.z())});
             },
             2.1, false}};
}

TEST(FitDistance, ZeroSetIsWithinThreeHundredthsOfAVoxelAndConverges) {
    for (const auto& ladder : ladders()) {
        // Quasi-interpolation is of fourth order: in world units the error falls 16x for a halved voxel.
        std::vector<double> rms;                   // in voxels
        for (const double voxels : {8.0, 16.0}) {  // per unit
            const auto distance = [&](const Vec3d& p) { return voxels * ladder.distance(p / voxels); };
            const int half = static_cast<int>(ladder.half * voxels) + 5;
            const auto field = fitDistance(
                *distanceFromFunction(distance, CoordBBox(-half, -half, -half, half, half, half), 4));
            rms.push_back(rmsOfZeroSet(field, distance));
        }
        const double ratio = rms[0] / (rms[1] / 2);
        std::printf("%s: rms %.2e voxel, with half the voxel %.2e; in world units 1/%.1f\n", ladder.name,
                    rms[0], rms[1], ratio);
        EXPECT_LT(rms[0], 0.03) << ladder.name;
        EXPECT_LT(rms[1], 0.03) << ladder.name;
        if (ladder.smooth) {
            EXPECT_GT(ratio, 12) << ladder.name;
        }  // seen 15.4
    }
}

TEST(FitDistance, GivesTheSameFieldWhereDistancesAreGivenUp) {
    for (const Ladder& ladder : ladders()) {
        const auto distance = [&](const Vec3d& p) { return 16 * ladder.distance(p / 16.0); };
        const int half = static_cast<int>(16 * ladder.half) + 5;
        const auto grid = distanceFromFunction(distance, CoordBBox(-half, -half, -half, half, half, half), 4);
        openvdb::FloatGrid::Ptr copy = grid->deepCopy();
        FitReport kept, given;
        const BSplineField field = fitDistance(*grid, {}, &kept);
        const BSplineField same = fitDistance(std::move(copy), {}, &given);
        EXPECT_EQ(copy, nullptr);
        EXPECT_EQ(given.repaired, kept.repaired);
        ASSERT_TRUE(same.controlPoints->tree().hasSameTopology(field.controlPoints->tree())) << ladder.name;
        for (auto c = field.controlPoints->cbeginValueAll(); c; ++c)
            ASSERT_EQ(*c, same.controlPoints->tree().getValue(c.getCoord())) << ladder.name;
    }
}

TEST(FitDistance, IsFarCloserThanTheBinaryFit) {
    const auto solid = zoo::cadSolids()[0];
    const auto distance = solid.distance;
    EXPECT_LT(rmsOfZeroSet(zoo::distanceField(solid), distance), 0.03);
    EXPECT_GT(rmsOfZeroSet(zoo::binaryField(solid), distance), 0.1);  // seen 0.19
}

// ---- images

// A grey image whose iso surface is a known one: values fall linearly across it.
Image greyImage(const std::function<double(const Vec3d&)>& distance, int size, double iso, double slope) {
    Image image;
    image.size = {size, size + 1, size + 2};
    for (int z = 0; z < image.size[2]; ++z)
        for (int y = 0; y < image.size[1]; ++y)
            for (int x = 0; x < image.size[0]; ++x)
                image.values.push_back(static_cast<float>(iso - slope * distance(Vec3d(x, y, z))));
    return image;
}

TEST(DistanceFromImage, FindsASubVoxelSurface) {
    const auto truth = [](const Vec3d& p) { return (p - Vec3d(15.3, 15.8, 16.1)).length() - 9.6; };
    const Image image = greyImage(truth, 32, 300, 57);
    const auto distance = distanceFromImage(image, {.iso = 300}, 4);
    double worst = 0, sum = 0;
    for (auto v = distance->cbeginValueOn(); v; ++v) {
        const double error = std::abs(*v - truth(v.getCoord().asVec3d()));
        worst = std::max(worst, error);
        sum += error * error;
    }
    EXPECT_LT(worst, 0.05);                                                               // seen 0.034
    EXPECT_LT(std::sqrt(sum / static_cast<double>(distance->activeVoxelCount())), 0.01);  // seen 0.0079
    EXPECT_LT(rmsOfZeroSet(fitDistance(*distance), truth), 0.002);                        // seen 0.0014
}

TEST(DistanceFromImage, SeesNoSurfaceDeepInside) {
    // Between the band and the tiles of the inside lies no surface: a sphere large enough to have such tiles.
    const auto truth = [](const Vec3d& p) { return (p - Vec3d(36.3, 36.8, 36.1)).length() - 30.2; };
    const auto distance = distanceFromImage(greyImage(truth, 72, 300, 57), {.iso = 300}, 4);
    EXPECT_EQ(distance->tree().getValue(Coord(36, 36, 36)), -4.0f);
    for (auto v = distance->cbeginValueOn(); v; ++v)
        ASSERT_LT(std::abs(*v - truth(v.getCoord().asVec3d())), 0.1) << v.getCoord();
}

TEST(DistanceFromImage, InvertTurnsTheSolidInsideOut) {
    const auto truth = [](const Vec3d& p) { return (p - Vec3d(15.3, 15.8, 16.1)).length() - 9.6; };
    const Image image = greyImage([&](const Vec3d& p) { return -truth(p); }, 32, 300, 57);
    const auto distance = distanceFromImage(image, {.iso = 300, .invert = true}, 4);
    EXPECT_LT(rmsOfZeroSet(fitDistance(*distance), truth), 0.03);
}

TEST(DistanceFromImage, CapsASolidThatTouchesTheBorderHalfAVoxelOutside) {
    Image image;
    image.size = {12, 9, 7};
    image.values.assign(12 * 9 * 7, 500.0f);
    const auto distance = distanceFromImage(image, {.iso = 300}, 4);
    EXPECT_NEAR(distance->tree().getValue(Coord(0, 4, 3)), -0.5, 1e-5);
    EXPECT_NEAR(distance->tree().getValue(Coord(-1, 4, 3)), 0.5, 1e-5);
    const auto nodes = nodesFromImage(image, {.iso = 300});
    EXPECT_FALSE(nodes.grid->tree().getValue(Coord(-1, 4, 3)));
    EXPECT_TRUE(nodes.grid->tree().getValue(Coord(11, 8, 6)));
    const auto open = nodesFromImage(image, {.iso = 300, .openBorder = true});
    EXPECT_TRUE(open.grid->tree().getValue(Coord(-kOpenBorder, 4, 3)));
}

TEST(DistanceFromImage, KeepsTheImagesTransform) {
    Image image = greyImage([](const Vec3d& p) { return (p - Vec3d(8)).length() - 4; }, 16, 0, 1);
    image.indexToWorld = {{{{0.5, 0.1, 0}, {-0.1, 0.6, 0}, {0, 0.2, 1.5}}}, {-100, 30, 7}};
    const auto field = fitDistance(*distanceFromImage(image, {.iso = 0}, 4));
    const auto shift = Coord::round(field.transform().worldToIndex(Vec3d(-100, 30, 7)));
    const Vec3d voxel(3, 5, 7);
    const auto expected = linearTransform(image.indexToWorld, "image")->indexToWorld(voxel);
    EXPECT_LT((field.transform().indexToWorld(voxel + shift.asVec3d()) - expected).length(), 1e-12);
}

TEST(DistanceFromLevelSet, RescalesAnyHalfWidthToVoxels) {
    const auto truth = [](const Vec3d& p) { return (p - Vec3d(0.3, 0.8, 0.1)).length() - 9.6; };
    auto source = distanceFromFunction(truth, CoordBBox(-16, -16, -16, 16, 16, 16), 2);
    for (auto v = source->beginValueAll(); v; ++v) v.setValue(*v * 0.25f);  // world units: a voxel is 0.25
    source->tree().root().setBackground(0.5f, false);
    source->setTransform(openvdb::math::Transform::createLinearTransform(0.25));
    const auto distance = distanceFromLevelSet(*source, 0, 4);
    double worst = 0;
    for (auto v = distance->cbeginValueOn(); v; ++v)
        worst = std::max(worst, std::abs(*v - truth(v.getCoord().asVec3d())));
    EXPECT_LT(worst, 0.05);  // seen 0.034
    EXPECT_EQ(distance->tree().getValue(Coord(0)), -4.0f);
    EXPECT_EQ(distance->transform(), source->transform());
}

TEST(Nodes, FromSignsAndFromAFunctionAreTheSame) {
    for (const auto& solid : zoo::allSolids()) {
        const NodeCollection expected = nodesFromFunction(solid.inside, solid.box);
        openvdb::BoolGrid signs(false);
        for (auto c = solid.box.begin(); c; ++c)
            if (solid.inside(*c)) signs.tree().setValue(*c, true);
        signs.tree().prune();
        const NodeCollection nodes = nodesFromSigns(signs);
        EXPECT_EQ(nodes.nodeCount(), expected.nodeCount()) << solid.name;
        for (auto n = expected.grid->cbeginValueOn(); n; ++n)
            ASSERT_TRUE(nodes.grid->tree().isValueOn(n.getCoord())) << solid.name;
    }
}

TEST(Nodes, AreTheUnitCubesWhoseCornerSignsDiffer) {
    for (const auto& solid : zoo::allSolids()) {
        const NodeCollection nodes = nodesFromFunction(solid.inside, solid.box);
        CoordBBox box = solid.box;
        box.expand(2);
        const auto inside = [&](const Coord& c) { return solid.box.isInside(c) && solid.inside(c); };
        std::int64_t count = 0;
        for (auto c = box.begin(); c; ++c) {
            int corners = 0;
            for (int b = 0; b < 8; ++b) corners += inside((*c).offsetBy(b >> 2, (b >> 1) & 1, b & 1));
            const bool stabbed = corners != 0 && corners != 8;
            ASSERT_EQ(nodes.grid->tree().isValueOn(*c), stabbed) << solid.name << *c;
            ASSERT_EQ(nodes.grid->tree().getValue(*c), inside(*c)) << solid.name << *c;
            count += stabbed;
        }
        EXPECT_EQ(nodes.nodeCount(), count) << solid.name;
    }
}

}  // namespace
}  // namespace isowave
