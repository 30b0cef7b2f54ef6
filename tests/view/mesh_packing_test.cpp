// What view/mesh_packing.h promises of its streams, by a reader that is written from that header.
#include <algorithm>
#include <set>

#include "tests/view/shapes.h"
#include "tests/view/unpacking.h"
#include "view/page.h"

namespace isowave::view {
namespace {

// Each triangle from its least corner on, sorted: what neither order nor first corner changes.
std::multiset<Triangle> normalized(std::vector<Triangle> triangles) {
    for (Triangle& t : triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return {triangles.begin(), triangles.end()};
}

std::vector<Triangle> renamed(std::vector<Triangle> triangles, const std::vector<std::uint32_t>& order) {
    for (Triangle& t : triangles)
        for (std::uint32_t& v : t) v = order.at(v);
    return triangles;
}

TEST(MeshPacking, EveryTriangleComesBackWithItsOrientation) {
    for (const NamedMesh& shape : zooOfMeshes()) {
        const PackedMesh mesh = packed(shape.mesh);
        const Unpacker unpacked(mesh);
        EXPECT_TRUE(unpacked.usedAll()) << shape.name;
        EXPECT_EQ(normalized(renamed(unpacked.mesh.triangles, mesh.order)), normalized(shape.mesh.triangles))
            << shape.name;
    }
}

TEST(MeshPacking, PointsComeBackToHalfAStep) {
    for (const NamedMesh& shape : zooOfMeshes()) {
        const PackedMesh mesh = packed(shape.mesh);
        const Unpacker unpacked(mesh);
        ASSERT_EQ(unpacked.mesh.points.size(), mesh.order.size()) << shape.name;
        for (std::size_t v = 0; v < mesh.order.size(); ++v)
            for (std::size_t axis = 0; axis < 3; ++axis)
                EXPECT_LE(std::abs(unpacked.mesh.points[v][axis] - shape.mesh.points[mesh.order[v]][axis]),
                          0.500001 * mesh.step)
                    << shape.name;
    }
}

TEST(MeshPacking, TheStepIsThe65535thOfTheLongestSide) {
    const PackedMesh mesh = packed(torus(24, 16));
    EXPECT_DOUBLE_EQ(mesh.step, 8.0 / 65535);
    EXPECT_DOUBLE_EQ(mesh.low[0], -4);
    EXPECT_DOUBLE_EQ(mesh.high[2], 1);
}

TEST(MeshPacking, CoordinatesFarFromTheOriginLoseNothingMore) {
    TriangleMesh far = torus(24, 16);
    for (Point& p : far.points) p[0] += 1e7;
    const PackedMesh mesh = packed(far);
    const Unpacker unpacked(mesh);
    for (std::size_t v = 0; v < mesh.order.size(); ++v)
        EXPECT_LE(std::abs(unpacked.mesh.points[v][0] - far.points[mesh.order[v]][0]), 0.50002 * mesh.step);
}

TEST(MeshPacking, OnlyPointsThatATriangleUsesAreStored) {
    EXPECT_EQ(packed(oddities()).vertices, 3);
    EXPECT_EQ(packed(TriangleMesh{}).triangles, 0);
}

TEST(MeshPacking, ARegularSurfaceTakesHalfAByteATriangle) {
    const TriangleMesh fine = torus(400, 250);  // 200,000 triangles
    const double bytes = static_cast<double>(deflated(packed(fine).bytes).size());
    EXPECT_LT(bytes / static_cast<double>(fine.triangles.size()), 0.5);  // seen 0.28; STL has 50
}

TEST(MeshPacking, HardlyAnyVertexIsNamed) {
    const PackedMesh mesh = packed(torus(400, 250));
    const auto named = static_cast<std::int64_t>(mesh.bytes.size()) - mesh.triangles - 6 * mesh.vertices;
    EXPECT_LT(named, mesh.triangles / 100);  // seen 0.46 %, in bytes
}

TEST(ValuePacking, ValuesComeBackToAStep) {
    const std::vector<float> values = {0, 0.25f, 3, 1e-3f, 2.9999f};
    const std::vector<std::uint32_t> order = {2, 0, 4, 1, 3};
    const Bytes bytes = packedValues(values, order, 3);
    int at = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        at = (at + signedOf(bytes[i], bytes[order.size() + i])) & 0xffff;
        EXPECT_NEAR(at * 3.0 / 65535, values[order[i]], 3.0 / 131000);
    }
}

TEST(RingPacking, RingsComeBackToHalfAStep) {
    const Rings rings = {{{-18.5, 3}, {50.25, 3.125}, {4, -34.75}}, {}, {{0.1, 0.2}, {0.3, 0.2}, {0.2, 0.4}}};
    const PackedRings mine = packedRings(rings);
    EXPECT_EQ(mine.rings, 3);
    EXPECT_EQ(mine.points, 6);
    Varints numbers(mine.bytes, 0);
    for (const auto& ring : rings) EXPECT_EQ(numbers.next(), ring.size());
    std::int64_t x = 0, y = 0;
    for (const auto& ring : rings)
        for (const curves2d::Point& p : ring) {
            x += numbers.nextSigned(), y += numbers.nextSigned();
            EXPECT_NEAR(mine.low.x + mine.step * static_cast<double>(x), p.x, 0.51 * mine.step);
            EXPECT_NEAR(mine.low.y + mine.step * static_cast<double>(y), p.y, 0.51 * mine.step);
        }
    EXPECT_TRUE(numbers.atEnd());
}

}  // namespace
}  // namespace isowave::view
