#include "polygonize/specks.h"

#include <gtest/gtest.h>

#include <numbers>

#include "polygonize/fields.h"
#include "polygonize/polygonize.h"
#include "wavelets/pyramid.h"
#include "zoo/mesh_check.h"
#include "zoo/zoo.h"

namespace isowave {
namespace {

using namespace isowave::testing;

// A ball of radius 9 with a bubble of radius `bubble` in it, in that a grain of radius `grain`, and a ball of
// radius `speck` beside it all.
BSplineField ballWithBubble(double bubble, double grain, double speck) {
    return fieldFromDistance(20, [=](const Vec3d& x) {
        const Vec3d middle(0.31, -0.17, 0.23), beside(11.4, 10.2, 9.7);
        const double r = (x - middle).length();
        return std::min({std::max(r - 9, bubble - r), r - grain, (x - beside).length() - speck});
    });
}

double ballVolume(double r) { return 4 * std::numbers::pi / 3 * r * r * r; }

TEST(Specks, AreComponentsSmallerThanTheThreshold) {
    TriangleMesh mesh = polygonize(ballWithBubble(4, 0, 2));
    ASSERT_EQ(topologyOf(mesh).parts, 2);
    ASSERT_EQ(topologyOf(mesh).cavities, 1);
    TriangleMesh all = mesh;
    const SpeckRemoval none = removeSpecks(all, 0.8 * ballVolume(2));
    EXPECT_EQ(none.specks + none.bubbles, 0);
    EXPECT_EQ(all.triangles, mesh.triangles);

    TriangleMesh noSpeck = mesh;
    const SpeckRemoval one = removeSpecks(noSpeck, 1.2 * ballVolume(2));
    EXPECT_EQ(one.specks, 1);
    EXPECT_EQ(one.bubbles, 0);
    EXPECT_NEAR(one.speckVolume, ballVolume(2), 0.15 * ballVolume(2));  // seen 0.12 less
    EXPECT_NEAR(topologyOf(noSpeck).volume, topologyOf(mesh).volume - one.speckVolume, 1e-9);

    const SpeckRemoval both = removeSpecks(mesh, 1.2 * ballVolume(4));
    EXPECT_EQ(both.specks, 1);
    EXPECT_EQ(both.bubbles, 1);
    EXPECT_NEAR(both.bubbleVolume, ballVolume(4), 0.05 * ballVolume(4));
    EXPECT_EQ(topologyOf(mesh).components, 1);
    EXPECT_EQ(zoo::whatIsWrongWith(mesh), "");
    EXPECT_EQ(mesh.normals.size(), mesh.points.size());
}

// What is a speck is for the component's least place to say: here the ball's, and not the bubble's.
TEST(Specks, GoByWhatIsTooSmallWhereTheyAre) {
    TriangleMesh mesh = polygonize(ballWithBubble(4, 0, 2));
    std::vector<double> smallest;
    for (const Point& p : mesh.points)  // the speck lies at (11.4, 10.2, 9.7)
        smallest.push_back(p[0] + p[1] + p[2] > 22 ? 0.8 * ballVolume(2) : 1.2 * ballVolume(4));
    TriangleMesh oneLarge = mesh;
    const SpeckRemoval bubble = removeSpecks(oneLarge, smallest);
    EXPECT_EQ(bubble.specks, 0);
    EXPECT_EQ(bubble.bubbles, 1);
    EXPECT_EQ(topologyOf(oneLarge).parts, 2);
    for (std::size_t v = 0; v < mesh.points.size(); ++v)  // one point of the bubble is in a finer place
        if (const Point& p = mesh.points[v]; p[0] > 3.5 && p[0] < 6 && std::hypot(p[1], p[2]) < 2)
            smallest[v] = 1;
    EXPECT_EQ(removeSpecks(mesh, smallest).bubbles, 0);
}

TEST(Specks, LeaveNothingInsideOfWhatWentAndNoInsideTurnedOut) {
    TriangleMesh mesh = polygonize(ballWithBubble(5, 2.5, 2));
    ASSERT_EQ(topologyOf(mesh).components, 4);
    EXPECT_NEAR(volumeWithoutSpecks(mesh, 1.1 * ballVolume(5)), ballVolume(9), 0.02 * ballVolume(9));
    removeSpecks(mesh, 1.1 * ballVolume(5));
    EXPECT_EQ(topologyOf(mesh).components, 1);
    EXPECT_NEAR(topologyOf(mesh).volume, ballVolume(9), 0.02 * ballVolume(9));
}

TEST(Specks, SpareTheLargestPart) {
    TriangleMesh mesh = polygonize(ballWithBubble(4, 0, 2));
    const SpeckRemoval removal = removeSpecks(mesh, 1e9);
    EXPECT_EQ(removal.specks, 1);
    EXPECT_EQ(removal.bubbles, 1);
    EXPECT_EQ(topologyOf(mesh).components, 1);
    EXPECT_EQ(areSpecks({1, 3, -9, 3}, 10), (std::vector<bool>{true, false, true, true}));
    EXPECT_TRUE(areSpecks({}, 10).empty());
    TriangleMesh empty;
    EXPECT_EQ(removeSpecks(empty, 1).specks, 0);
}

TEST(Specks, NodeVolumeIsThatOfTheTransform) {
    const auto transform = openvdb::math::Transform::createLinearTransform(
        openvdb::math::Mat4d(2., 0., 0., 0., 0., 0., -3., 0., 0., 1.5, 0., 0., 7., 8., 9., 1.));
    EXPECT_DOUBLE_EQ(nodeVolume(*transform), 9);
}

TEST(Specks, GoFromEveryStepOfTheZooAndLeaveAManifold) {
    for (const auto& [name, field] : zoo::allFields())
        wavelets::analyse(field, {}, {}, [&, &name = name](int step, const BSplineField& at) {
            TriangleMesh mesh = polygonize(at);
            if (mesh.triangles.empty()) return;
            const double node = nodeVolume(at.transform());
            const MeshTopology before = topologyOf(mesh);
            const double expected = volumeWithoutSpecks(mesh, node);
            const SpeckRemoval removal = removeSpecks(mesh, node);
            const MeshTopology after = topologyOf(mesh);
            const std::string what = name + ", step " + std::to_string(step);
            EXPECT_EQ(zoo::whatIsWrongWith(mesh), "") << what;
            EXPECT_EQ(after.parts, before.parts - removal.specks) << what;
            EXPECT_EQ(after.cavities, before.cavities - removal.bubbles) << what;
            EXPECT_NEAR(after.volume, expected, 1e-9 * std::max(1.0, expected)) << what;
            EXPECT_GE(after.parts, 1) << what;
            for (std::size_t i = 1; i < after.each.size(); ++i)
                EXPECT_GE(std::abs(after.each[i].volume), node) << what;
        });
}

}  // namespace
}  // namespace isowave
