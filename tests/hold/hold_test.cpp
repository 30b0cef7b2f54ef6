// The promises of hold/hold.h.
#include "hold/hold.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "tests/zoo/box.h"
#include "volume/distance_mesh.h"
#include "volume/fit.h"
#include "wavelets/direction.h"

namespace isowave {
namespace {

using openvdb::Vec3d;

constexpr int kH = 4;  // the voxel of level 2

// Plates, tilted, off the lattice, 40 wide, from low to high.
BSplineField platesOf(const std::vector<std::array<double, 2>>& plates) {
    const auto turn = openvdb::math::rotation<openvdb::math::Mat3d>(Vec3d(0.958, -0.287, 0).unit(), 0.3);
    TriangleMesh mesh;
    for (const auto& [low, high] : plates) {
        const auto first = static_cast<std::uint32_t>(mesh.points.size());
        for (int i = 0; i < 8; ++i) {
            const Vec3d p = turn * Vec3d(i & 1 ? 20 : -20, i & 2 ? 20 : -20, i & 4 ? high : low) +
                            Vec3d(40.31, 39.83, 40.23);
            mesh.points.push_back({p[0], p[1], p[2]});
        }
        for (const Triangle& t : zoo::kBoxTriangles)
            mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return fitDistance(*distanceFromMesh(mesh, *openvdb::math::Transform::createLinearTransform(1.0), 4));
}

BSplineField plateOf(double t) { return platesOf({{-t / 2, t / 2}}); }

BSplineField levelOf(BSplineField field, int level) {
    for (int step = 0; step < 3 * level; ++step) field = wavelets::analyseDirection(field, step % 3).coarse;
    return field;
}

struct Levels {
    BSplineField finest, plain;
    std::unique_ptr<LevelHold> hold;

    explicit Levels(double thickness, int level = 2) : Levels(plateOf(thickness), level) {}
    explicit Levels(BSplineField field, int level = 2)
        : finest(std::move(field)), plain(levelOf(finest, level)) {
        const TriangleMesh mesh = polygonize(finest, {.refine = 2});
        hold =
            std::make_unique<LevelHold>(surfaceOf(mesh, componentsOf(mesh), finest.transform(), 2), finest);
    }
    BSplineField held(int refine, HoldReport* report = nullptr, const HoldOptions& options = {}) const {
        BSplineField field = plain;
        field.controlPoints = plain.controlPoints->deepCopy();
        const HoldReport made = hold->apply(field, refine, options);
        if (report) *report = made;
        return field;
    }
};

std::vector<float> valuesOf(const BSplineField& field) {
    std::vector<float> values;
    for (auto voxel = field.controlPoints->cbeginValueOn(); voxel; ++voxel) values.push_back(*voxel);
    return values;
}

double volumeOf(const BSplineField& field, int refine) {
    return topologyOf(polygonize(field, {.refine = refine})).volume;
}

TEST(LevelHold, EverySampleIsInsideAndEveryHardRowIsMet) {
    for (const double share : {0.25, 0.375, 0.5, 0.75}) {
        const Levels levels(share * kH);
        HoldReport report;
        const BSplineField held = levels.held(4, &report);
        ASSERT_GT(report.samples, 100) << share;
        EXPECT_EQ(report.insideBefore < report.samples, share < 0.6) << share;
        EXPECT_EQ(report.inside, report.samples) << share;
        EXPECT_EQ(report.unmet, 0) << share;
        const MeshTopology mesh = topologyOf(polygonize(held, {.refine = 4}));
        EXPECT_EQ(mesh.parts, 1) << share;
        EXPECT_EQ(mesh.genus, 0) << share;
        // Counted once more, by evaluate(): samples are in level 0's index space, points of level 2 lie at i/4.
        std::int64_t outside = 0, thin = 0;
        for (const ThinSample& sample : levels.hold->samples()) {
            if (sample.thickness >= 1.2 * share * kH) continue;
            ++thin;
            const Vec3d world = levels.finest.transform().indexToWorld(Vec3d(sample.at));
            outside += evaluate(held, held.transform().worldToIndex(world)) >= 0;
        }
        EXPECT_GT(thin, 100) << share;
        EXPECT_EQ(outside, 0) << share;
    }
}

TEST(LevelHold, TheCorrectionVanishesAsWallsGetThicker) {
    constexpr double kH3 = 8;
    double before = HUGE_VAL;
    for (const double share : {0.125, 0.25, 0.5, 1.0, 2.0}) {  // of H
        const Levels levels(share * kH3, 3);
        HoldReport report;
        const BSplineField held = levels.held(4, &report);
        const MeshTopology mesh = topologyOf(polygonize(held, {.refine = 4}));
        EXPECT_EQ(mesh.parts, 1) << share;
        EXPECT_EQ(mesh.genus, 0) << share;
        const double swells = mesh.volume / volumeOf(levels.finest, 2) - 1;
        EXPECT_LT(swells, before + 0.02) << share;
        before = std::max(swells, 0.0);
        if (share < 0.2) {
            EXPECT_GT(report.thickened, report.samples / 2);
        }
        if (share >= 0.5) {
            EXPECT_LT(std::abs(swells), share < 1 ? 0.15 : 0.08) << share;  // coarse levels round off rims
            EXPECT_EQ(report.thickened, 0) << share;
        }
        EXPECT_EQ(report.changed > 0, share < 2) << share;
    }
}

TEST(LevelHold, AGapThatIsToCloseClosesEverywhere) {
    const Levels levels(platesOf({{-9, -0.7}, {0.7, 9}}));  // a gap of 0.35 H
    const MeshTopology open = topologyOf(polygonize(levels.plain));
    EXPECT_GT(open.components + open.genus, 1);  // without the rule it closes here and there
    HoldOptions options;
    options.closedGaps = 0.5;
    HoldReport report;
    const MeshTopology closed = topologyOf(polygonize(levels.held(1, &report, options)));
    EXPECT_GT(report.gaps, 1000);
    EXPECT_EQ(report.unmet, 0);
    EXPECT_EQ(closed.components, 1);
    EXPECT_EQ(closed.genus, 0);
    EXPECT_NEAR(closed.volume, 40 * 40 * 18, 0.03 * 40 * 40 * 18);
    options.closedGaps = 0.2;  // wider gaps stay as they are
    EXPECT_EQ(valuesOf(levels.held(1, &report, options)), valuesOf(levels.plain));
    EXPECT_EQ(report.gaps, 0);
}

TEST(LevelHold, WhatIsThickKeepsItsBits) {
    const Levels levels(2 * kH);
    HoldReport report;
    EXPECT_EQ(valuesOf(levels.held(1, &report)), valuesOf(levels.plain));
    EXPECT_EQ(report.samples, 0);
}

TEST(LevelHold, WhatIsThickAsksForNoFinerSampling) {
    const Levels thick(4 * kH), bar(2 * kH), thin(0.5 * kH);
    EXPECT_EQ(thick.hold->refineFor(thick.plain), 1);
    EXPECT_EQ(bar.hold->refineFor(bar.plain), 2);  // triangles on a lattice of H would cut its corners
    EXPECT_GT(thin.hold->refineFor(thin.plain), 1);
}

TEST(LevelHold, TheLevelsGivenStayAsTheyAre) {
    const Levels levels(0.5 * kH);
    const std::vector<float> finest = valuesOf(levels.finest), plain = valuesOf(levels.plain);
    EXPECT_NE(valuesOf(levels.held(4)), plain);
    EXPECT_EQ(valuesOf(levels.finest), finest);
    EXPECT_EQ(valuesOf(levels.plain), plain);
}

TEST(LevelHold, GivesTheSameBitsForAnyThreads) {
    const Levels levels(0.5 * kH);
    std::vector<std::vector<float>> results;
    for (const std::size_t threads : {1, 4}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        results.push_back(valuesOf(levels.held(4)));
    }
    EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace isowave
