// The promises of volume/walls/between.h, and what fitWalls() makes of them.
#include "volume/walls/between.h"
#include "tests/zoo/box.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volume/distance_mesh.h"
#include "volume/fit.h"
#include "volume/walls/wall_fit.h"

namespace isowave {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;

struct Solid {
    std::vector<Vec3d> points;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> component;  // of each point

    // inverted: as the border of a cavity.
    void addBox(const Vec3d& low, const Vec3d& high, bool inverted = false) {
        const auto first = static_cast<std::uint32_t>(points.size());
        for (int i = 0; i < 8; ++i) {
            points.emplace_back(i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
            component.push_back(first / 8);
        }
        for (const Triangle& t : zoo::kBoxTriangles) {
            const Triangle shifted{first + t[0], first + t[inverted ? 2 : 1], first + t[inverted ? 1 : 2]};
            triangles.push_back(shifted);
        }
    }
    FineSigns signs(int perVoxel = 4) const { return {points, triangles, perVoxel, false}; }
    bool touches() const { return componentsTouch(points, triangles, component, points.size() / 8, signs()); }
};

// A profile of quads in the xy-plane, `depth` long: an L of two walls.
Solid angleOf(double wall, double side, double depth) {
    const std::vector<Vec3d> profile{{0, 0, 0},       {side, 0, 0},    {side, wall, 0},
                                     {wall, wall, 0}, {wall, side, 0}, {0, side, 0}};
    Solid solid;
    const auto n = static_cast<std::uint32_t>(profile.size());
    for (const double z : {0.0, depth})
        for (const Vec3d& p : profile) {
            const double c = std::cos(0.3), s = std::sin(0.3);
            solid.points.emplace_back(c * p[0] - s * p[1] + 20.13, s * p[0] + c * p[1] + 20.31, z + 20.22);
            solid.component.push_back(0);
        }
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        solid.triangles.push_back({i, j, n + j});
        solid.triangles.push_back({i, n + j, n + i});
    }
    for (const Triangle& t : {Triangle{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
        solid.triangles.push_back({t[0], t[2], t[1]});
        solid.triangles.push_back({n + t[0], n + t[1], n + t[2]});
    }
    return solid;
}

TEST(FineSigns, CountTheVolume) {
    Solid solid;
    solid.addBox({0.5, 0.5, 0.5}, {10.5, 5.5, 3.5});
    EXPECT_EQ(solid.signs(1).lines().insideCount(), 150);
    EXPECT_DOUBLE_EQ(solid.signs(4).volume(), 150);
    solid.addBox({2.5, 1.5, 1.5}, {4.5, 3.5, 2.5}, true);
    EXPECT_DOUBLE_EQ(solid.signs(4).volume(), 146);
}

TEST(FineSigns, CountWhatOverlapsOnce) {
    Solid solid;
    solid.addBox({0.5, 0.5, 0.5}, {10.5, 10.5, 10.5});
    solid.addBox({5.5, 5.5, 5.5}, {15.5, 15.5, 15.5});
    EXPECT_TRUE(solid.signs(2).lines().hasOverlap());
    EXPECT_DOUBLE_EQ(solid.signs(2).volume(), 1875);
}

TEST(FineSigns, GetCoarserWhereTheyWouldTakeTooMuch) {
    Solid small, large;
    small.addBox({0, 0, 0}, {100, 100, 100});
    large.addBox({0, 0, 0}, {2000, 2000, 2000});
    EXPECT_EQ(finestSigns(small.points, small.triangles), 4);
    EXPECT_EQ(finestSigns(large.points, large.triangles), 1);
    Solid apart, wire;  // next to no area, but many lines or a long way
    apart.addBox({0, 0, 0}, {2, 2, 2});
    apart.addBox({0, 6000, 6000}, {2, 6002, 6002});
    wire.addBox({0, 0, 0}, {4e5, 2, 2});
    EXPECT_EQ(finestSigns(apart.points, apart.triangles), 1);
    EXPECT_EQ(finestSigns(wire.points, wire.triangles), 2);
}

TEST(ComponentsTouch, WhereTheyOverlapOrShareAFace) {
    Solid apart, overlapping, touching;
    for (Solid* solid : {&apart, &overlapping, &touching}) solid->addBox({0.1, 0.1, 0.1}, {10.1, 10.1, 10.1});
    apart.addBox({10.6, 0.1, 0.1}, {20.1, 10.1, 10.1});
    overlapping.addBox({9.6, 0.1, 0.1}, {20.1, 10.1, 10.1});
    touching.addBox({10.1, 0.1, 0.1}, {20.1, 10.1, 10.1});
    EXPECT_FALSE(apart.touches());
    EXPECT_TRUE(overlapping.touches());
    EXPECT_TRUE(touching.touches());
}

TEST(ComponentsTouch, NotWhereACavityIsOnlyNear) {
    Solid hollow;
    hollow.addBox({0.1, 0.1, 0.1}, {20.1, 20.1, 20.1});
    hollow.addBox({0.8, 0.8, 0.8}, {19.4, 19.4, 19.4}, true);
    EXPECT_FALSE(hollow.touches());
    // A ball in it that touches its wall.
    hollow.addBox({0.8, 5.1, 5.1}, {5.1, 9.1, 9.1});
    EXPECT_TRUE(hollow.touches());
}

struct Fitted {
    BSplineField field;
    WallFitReport walls;
    std::size_t wrong = 0;  // places between lattice points, farther than 0.06 voxel from the mesh
};

Fitted fitted(const Solid& solid, bool between) {
    TriangleMesh mesh;
    for (const Vec3d& p : solid.points) mesh.points.push_back({p[0], p[1], p[2]});
    mesh.triangles = solid.triangles;
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    const auto distance = distanceFromMesh(mesh, *transform, 4);
    const FineSigns signs = solid.signs();
    Fitted result;
    Coord moved;
    DistanceFitOptions options;
    options.adjust = [&](BSplineField& field, const Coord& shift) {
        moved = shift;
        result.walls = fitWalls(field, distance->tree(), shift, solid.points, solid.triangles,
                                {.between = between ? &signs : nullptr});
    };
    result.field = fitDistance(*distance, options);
    const openvdb::MaskTree all(distance->tree(), false, true, openvdb::TopologyCopy());
    result.wrong = wrongPlaces(result.field, moved, all, signs, {solid.points, solid.triangles}, 0.06).size();
    return result;
}

TEST(WrongPlaces, AreThoseWhereEvaluateSaysSo) {
    const Solid angle = angleOf(0.8, 12, 15);
    const Fitted plain = fitted(angle, false);
    const FineSigns signs = angle.signs();
    const TriangleHierarchy hierarchy(angle.points, angle.triangles);
    openvdb::MaskTree near;
    near.fill({Coord(16, 18, 18), Coord(36, 36, 38)}, true);
    near.voxelizeActiveTiles();
    std::size_t count = 0;
    for (int x = 64; x < 148; ++x)
        for (int y = 72; y < 148; ++y)
            for (int z = 72; z < 156; ++z) {
                const Vec3d at = Vec3d(x, y, z) / 4;
                if ((evaluate(plain.field, at) < 0) == signs.inside(Coord(x, y, z))) continue;
                count += hierarchy.nearest(at, {4, -1}).squared >= 0.0036;
            }
    EXPECT_GT(count, 0u);
    EXPECT_EQ(wrongPlaces(plain.field, Coord(0), near, signs, hierarchy, 0.06).size(), count);
}

TEST(WallFit, SignsAreRightBetweenLatticePointsWhereWallsMeet) {
    for (const double wall : {0.6, 0.8, 1.0}) {
        const Solid angle = angleOf(wall, 12, 15);
        const Fitted plain = fitted(angle, false), mended = fitted(angle, true);
        EXPECT_EQ(plain.walls.between, 0);
        EXPECT_GT(mended.walls.between, 0) << wall;
        EXPECT_GT(plain.wrong, 10u) << wall;
        EXPECT_LT(mended.wrong, plain.wrong / 5) << wall;
    }
}

}  // namespace
}  // namespace isowave
