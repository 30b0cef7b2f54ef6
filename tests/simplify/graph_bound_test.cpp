// A piece over a surface that is a graph over it, and what must not be taken for one.
#include "simplify/graph_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/triangle.h"
#include "simplify/distance.h"

namespace isowave {
namespace {

// A square of 20 x 20 cells over [0, 20]^2, at the height f(x, y).
template <class Height>
TriangleMesh sheet(const Height& f) {
    constexpr std::uint32_t kCells = 20, kRow = kCells + 1;
    TriangleMesh mesh;
    for (std::uint32_t y = 0; y < kRow; ++y)
        for (std::uint32_t x = 0; x < kRow; ++x)
            mesh.points.push_back({double(x), double(y), f(double(x), double(y))});
    for (std::uint32_t y = 0; y < kCells; ++y)
        for (std::uint32_t x = 0; x < kCells; ++x) {
            const std::uint32_t a = y * kRow + x;
            mesh.triangles.push_back({a, a + 1, a + kRow + 1});
            mesh.triangles.push_back({a, a + kRow + 1, a + kRow});
        }
    return mesh;
}

constexpr std::array<Vec3, 3> kPiece{Vec3{1.3, 1.1, 0}, Vec3{18.2, 2.7, 0}, Vec3{7.9, 17.6, 0}};
constexpr double kAny = 1e9;

std::uint32_t below(const TriangleMesh& mesh) { return DistanceTarget(mesh).nearest({9, 7, 0}).triangle; }

TEST(GraphBound, IsTheLargestHeightOverThePiece) {
    const TriangleMesh mesh = sheet([](double x, double y) { return 0.1 * std::sin(x) * std::cos(0.7 * y); });
    const auto bound = GraphBound(mesh).over(kPiece, below(mesh), kAny);
    ASSERT_TRUE(bound);
    double most =
        0;  // of samples: heights of the piecewise linear surface are at most those of its vertices, 0.1
    const DistanceTarget target(mesh);
    for (double u = 0; u <= 1; u += 0.01)
        for (double v = 0; u + v <= 1; v += 0.01) {
            const Vec3 p = (1 - u - v) * kPiece[0] + u * kPiece[1] + v * kPiece[2];
            most = std::max(most, target.distance({p.x, p.y, p.z}));
        }
    EXPECT_GE(*bound, most);
    EXPECT_LE(*bound, 0.1);
    EXPECT_GT(most, 0.08);  // so that the two say something
}

TEST(GraphBound, IsZeroOnAPlaneCutIntoOtherTriangles) {
    const TriangleMesh mesh = sheet([](double, double) { return 0.0; });
    EXPECT_EQ(GraphBound(mesh).over(kPiece, below(mesh), 0), 0);
}

TEST(GraphBound, KnowsNothingWhereATriangleIsMissingOrFacesAway) {
    TriangleMesh mesh = sheet([](double, double) { return 0.01; });
    const std::uint32_t hole = below(mesh), seed = hole - 4;
    ASSERT_TRUE(GraphBound(mesh).over(kPiece, seed, kAny));
    TriangleMesh open = mesh;
    open.triangles.erase(open.triangles.begin() + hole);
    EXPECT_FALSE(GraphBound(open).over(kPiece, seed, kAny));
    mesh.points[mesh.triangles[hole][0]] = {12, 9.5, 0.01};  // over its neighbours: some turn round
    EXPECT_FALSE(GraphBound(mesh).over(kPiece, seed, kAny));
}

TEST(GraphBound, KnowsNothingBeyondTheSurfaceAndAboveTheLimit) {
    const TriangleMesh mesh = sheet([](double, double) { return 0.01; });
    const GraphBound bound(mesh);
    const std::array<Vec3, 3> beyond{kPiece[0], Vec3{25, 3, 0}, kPiece[2]};
    EXPECT_FALSE(bound.over(beyond, below(mesh), kAny));
    EXPECT_FALSE(bound.over(kPiece, below(mesh), 0.009));
    EXPECT_TRUE(bound.over(kPiece, below(mesh), 0.011));
    const std::array<Vec3, 3> turned{kPiece[0], kPiece[2], kPiece[1]};
    EXPECT_FALSE(bound.over(turned, below(mesh), kAny));
}

}  // namespace
}  // namespace isowave
