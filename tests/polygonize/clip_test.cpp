// The promises of polygonize/clip.h, and what an open image border becomes.
#include "polygonize/clip.h"
#include "volume/linear_transform.h"

#include <gtest/gtest.h>

#include <cmath>

#include "polygonize/polygonize.h"
#include "polygonize/topology.h"
#include "volume/distance.h"
#include "volume/fit.h"

namespace isowave {
namespace {

using openvdb::Mat4d;
using openvdb::Vec3d;

TriangleMesh cube() {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.points.push_back({double(i >> 2), double((i >> 1) & 1), double(i & 1)});
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                      {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
    return mesh;
}

TEST(Clip, LeavesWhatLiesInsideAlone) {
    const auto mesh = clipToBox(cube(), Mat4d::identity(), Vec3d(-1), Vec3d(2));
    EXPECT_EQ(mesh.points, cube().points);
    EXPECT_EQ(mesh.triangles, cube().triangles);
}

TEST(Clip, CutsExactlyAtTheFaceAndMakesSharedVerticesOnce) {
    ASSERT_TRUE(topologyOf(cube()).closed());
    const auto mesh = clipToBox(cube(), Mat4d::identity(), Vec3d(-1), Vec3d(0.25, 2, 2));
    const MeshTopology topology = topologyOf(mesh);
    EXPECT_NEAR(topology.area, 1 + 4 * 0.25, 1e-12);
    EXPECT_TRUE(topology.manifold());
    EXPECT_TRUE(topology.oriented());
    EXPECT_EQ(topology.boundaryEdges, 8);  // each of four sides is two triangles
    EXPECT_EQ(topology.components, 1);
    for (const Point& p : mesh.points) EXPECT_LE(p[0], 0.25);
}

TEST(Clip, WorksInTheImagesOwnAxes) {
    // Index = world / 2 with x and y exchanged.
    const Mat4d worldToIndex(0., .5, 0., 0., .5, 0., 0., 0., 0., 0., .5, 0., 0., 0., 0., 1.);
    const auto mesh = clipToBox(cube(), worldToIndex, Vec3d(0.125, -1, -1), Vec3d(1));
    for (const Point& p : mesh.points) EXPECT_GE(p[1], 0.25);
    EXPECT_NEAR(topologyOf(mesh).area, 1 + 4 * 0.75, 1e-12);
}

TEST(Clip, EverythingOutsideIsAnEmptyMesh) {
    const auto mesh = clipToBox(cube(), Mat4d::identity(), Vec3d(2), Vec3d(3));
    EXPECT_TRUE(mesh.points.empty());
    EXPECT_TRUE(mesh.triangles.empty());
}

TEST(Clip, AnOpenBorderLeavesTheCapOut) {
    // A rod along x that runs through the whole image: with the cap a closed cylinder, without it a tube
    // whose ends lie in the first and last plane of voxels.
    Image image;
    image.size = {20, 24, 24};
    for (int z = 0; z < 24; ++z)
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 20; ++x) image.values.push_back(float(8 - std::hypot(y - 11.3, z - 12.1)));
    const auto closed = polygonize(fitDistance(*distanceFromImage(image, {.iso = 0}, 4)));
    EXPECT_TRUE(topologyOf(closed).closed());
    const auto field = fitDistance(*distanceFromImage(image, {.iso = 0, .openBorder = true}, 4));
    const auto mesh =
        clipToBox(polygonize(field), matrixOf(image.indexToWorld).inverse(), Vec3d(0), Vec3d(19, 23, 23));
    const MeshTopology topology = topologyOf(mesh);
    EXPECT_FALSE(topology.closed());
    EXPECT_TRUE(topology.manifold());
    EXPECT_NEAR(topology.area, 2 * M_PI * 8 * 19, 0.01 * 2 * M_PI * 8 * 19);
    double low = 1e9, high = -1e9;
    for (const Point& p : mesh.points) low = std::min(low, p[0]), high = std::max(high, p[0]);
    EXPECT_NEAR(low, 0, 1e-9);
    EXPECT_NEAR(high, 19, 1e-9);
}

// Vertices of a polygonized field lie on lattice edges, many of them in the very planes where the image ends.
TEST(Clip, MakesNoTrianglesOfNoWidth) {
    Image image;
    image.size = {20, 24, 24};
    // Turned and moved, so that world coordinates of lattice planes are rounded.
    image.indexToWorld = {{{{.3, .4, 0}, {-.4, .3, 0}, {0, 0, .7}}}, {113.7, -41.3, 17.9}};
    for (int z = 0; z < 24; ++z)
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 20; ++x)
                image.values.push_back(float(8 - std::hypot(y - 11.3, z - 12.1) + std::sin(0.7 * x)));
    const auto field = fitDistance(*distanceFromImage(image, {.iso = 0, .openBorder = true}, 4));
    const auto mesh =
        clipToBox(polygonize(field), matrixOf(image.indexToWorld).inverse(), Vec3d(0), Vec3d(19, 23, 23));
    ASSERT_GT(mesh.triangles.size(), 1000u);
    double shortest = 1e9;
    for (const Triangle& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const Point &a = mesh.points[t[i]], &b = mesh.points[t[(i + 1) % 3]];
            shortest = std::min(shortest, std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
        }
    EXPECT_GT(shortest, 1e-5) << "one edge a triangle may be short, none of rounding's size";
    EXPECT_TRUE(topologyOf(mesh).manifold());
    EXPECT_TRUE(topologyOf(mesh).oriented());
}

TEST(Clip, KeepsVerticesOnTheFaceWithoutDoublingThem) {
    TriangleMesh mesh;
    mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 1, 3}, {0, 4, 1}, {1, 2, 3}, {2, 1, 4}};
    const auto upper = clipToBox(mesh, Mat4d::identity(), Vec3d(-5, -5, 0), Vec3d(5));
    EXPECT_EQ(upper.triangles.size(), 2u);
    EXPECT_EQ(upper.points.size(), 4u);
}

}  // namespace
}  // namespace isowave
