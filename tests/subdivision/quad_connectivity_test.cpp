// Finding the coarse mesh inside a fine one that says nothing about how it was made.
#include "subdivision/meshes/quad_connectivity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "isowave/error.h"
#include "subdivision/meshes/catmull_clark.h"
#include "subdivision/meshes/hierarchy.h"
#include "tests/subdivision/mesh_zoo.h"
#include "tests/subdivision/refusal.h"

namespace isowave::subdivision {
namespace {

using namespace mesh_zoo;
using testing::HasSubstr;

const MeshScheme& scheme() { return meshScheme("catmull-clark"); }

std::string complaint(const PolygonMesh& mesh, int levels = 1) {
    return subdivision::complaint([&] { recoverQuads(mesh, levels, {}); });
}

// Faces as sets of points, so that meshes in different orders compare.
std::multiset<std::vector<std::array<double, 3>>> shapeOf(const PolygonMesh& mesh) {
    std::multiset<std::vector<std::array<double, 3>>> faces;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        std::vector<std::array<double, 3>> points;
        for (const Index v : mesh.face(f))
            points.push_back({std::round(1e6 * mesh.points[v].x), std::round(1e6 * mesh.points[v].y),
                              std::round(1e6 * mesh.points[v].z)});
        std::rotate(points.begin(), std::min_element(points.begin(), points.end()), points.end());
        faces.insert(points);
    }
    return faces;
}

TEST(QuadConnectivity, FindsTheBaseOfWhatWasSubdividedInTheSameOrder) {
    for (const auto& [name, mesh] : all()) {
        for (const int levels : {1, 2}) {
            const Hierarchy found =
                decompose(subdivided(mesh, scheme(), levels), scheme(), "refined", levels);
            EXPECT_EQ(found.base.corners, mesh.corners) << name;
            EXPECT_EQ(found.base.faceBegin, mesh.faceBegin) << name;
            EXPECT_EQ(found.base.creases, mesh.creases) << name;
            EXPECT_EQ(found.base.pinned, mesh.pinned) << name;
            EXPECT_TRUE(found.order.empty()) << name;
            EXPECT_LT(distance(found.base.points, mesh.points), 1e-12 * 10) << name;  // seen 2e-14
            for (const auto& details : found.details) EXPECT_LT(largest(details), 1e-12) << name;
        }
    }
}

TEST(QuadConnectivity, FindsItInAnyOrderOfVerticesAndFaces) {
    for (const auto& [name, mesh] : all()) {
        const PolygonMesh fine = shuffled(subdivided(mesh, scheme(), 2), 11);
        const Hierarchy found = decompose(fine, scheme(), "refined", 2);
        EXPECT_EQ(shapeOf(found.base), shapeOf(mesh)) << name;
        for (const auto& details : found.details) EXPECT_LT(largest(details), 1e-12) << name;
        // Everything comes back where it was.
        const PolygonMesh back = reconstruct(found);
        EXPECT_EQ(back.corners, fine.corners) << name;
        EXPECT_LT(distance(back.points, fine.points), 1e-12 * diagonal(fine.points)) << name;
    }
}

TEST(QuadConnectivity, FindsItUnderDetails) {
    for (const auto& [name, mesh] : injective()) {
        PolygonMesh fine = subdivided(mesh, scheme(), 2);
        Random random(12);
        for (Vec3& p : fine.points) p += 0.002 * random.vector();  // 0.02 makes the octahedron a cube
        fine = shuffled(fine, 13);
        for (const char* variant : {"refined", "trial", "unscaled", "tensor"}) {
            const Hierarchy found = decompose(fine, scheme(), variant, 2);
            EXPECT_EQ(found.base.vertexCount(), mesh.vertexCount()) << name;
            const PolygonMesh back = reconstruct(found);
            EXPECT_EQ(back.corners, fine.corners) << name;
            EXPECT_LT(distance(back.points, fine.points), kMeshRoundTrip * diagonal(fine.points))
                << name << variant;
        }
    }
}

TEST(QuadConnectivity, GoesAsFarAsItCanWhenNothingIsAsked) {
    EXPECT_EQ(recoverQuads(subdivided(pyramid(5), scheme(), 3), kAllLevels, {}).size(), 3u);
    EXPECT_EQ(recoverQuads(subdivided(octahedron(), scheme(), 2), kAllLevels, {}).size(), 2u);
    // A torus of 24 x 20: 12 x 10, 6 x 5; and a torus of 32 x 32 ends at 4 x 4, since 2 x 2 has double edges.
    EXPECT_EQ(recoverQuads(torus(24, 20), kAllLevels, {}).size(), 2u);
    EXPECT_EQ(recoverQuads(torus(32, 32), kAllLevels, {}).size(), 3u);
}

// The cube and the octahedron have the same subdivision connectivity; the points tell them apart.
TEST(QuadConnectivity, OfSeveralAnswersTakesTheOneWithTheLeastDetails) {
    for (const PolygonMesh& mesh : {cube(), octahedron()}) {
        const auto found = recoverQuads(shuffled(subdivided(mesh, scheme(), 1), 14), 1, {});
        EXPECT_EQ(found[0].coarse.vertexCount(), mesh.vertexCount());
    }
    // Twice subdivided, only the octahedron's own faces can be made coarser twice, whatever the points are.
    PolygonMesh fine = subdivided(octahedron(), scheme(), 2);
    Random random(15);
    for (Vec3& p : fine.points) p = random.vector();
    EXPECT_EQ(recoverQuads(fine, 2, {})[1].coarse.faceCount() % 2, 0u);
}

TEST(QuadConnectivity, OfEqualAnswersTakesTheLowestVertexOfTheFirstFace) {
    PolygonMesh mesh = torus(8, 8);
    std::fill(mesh.points.begin(), mesh.points.end(), Vec3{});  // all ways have the same details, 0
    EXPECT_EQ(recoverQuads(mesh, 1, {})[0].fineCorner[0], mesh.faceBegin[0]) << "vertex 0 stays";
}

TEST(QuadConnectivity, CreasesDecideToo) {
    // A regular torus can be halved in four ways, but a crease along a row of odd number belongs to two of them only.
    PolygonMesh mesh = torus(12, 12);
    for (Index i = 0; i < 12; ++i) mesh.creases.push_back({5 * 12 + i, 5 * 12 + (i + 1) % 12, 3});
    const auto found = recoverQuads(mesh, 1, {});
    EXPECT_EQ(found[0].coarse.creases.size(), 6u);
    EXPECT_TRUE(defects(found[0].coarse).empty());
    mesh.pinned = {5 * 12 + 3};
    const auto pinned = recoverQuads(mesh, 1, {});
    ASSERT_EQ(pinned[0].coarse.pinned.size(), 1u);
    EXPECT_EQ(pinned[0].coarse.points[pinned[0].coarse.pinned[0]], mesh.points[5 * 12 + 3]);
}

TEST(QuadConnectivity, SaysWhatIsInTheWay) {
    EXPECT_THAT(complaint(tetrahedron()), HasSubstr("has 3 corners, but every face must be a quad"));
    EXPECT_THAT(complaint(cube()), HasSubstr("no Catmull-Clark connectivity: vertex"));
    EXPECT_THAT(complaint(grid(3, 4)), HasSubstr("no Catmull-Clark connectivity"));
    EXPECT_THAT(complaint(subdivided(cube(), scheme(), 1), 3), HasSubstr("for 1 level but not for 3"));
    EXPECT_THAT(complaint(subdivided(cube(), scheme(), 1), 3), HasSubstr("take --levels 1"));
    PolygonMesh halfCrease = subdivided(grid(4, 4), scheme(), 1);
    halfCrease.creases.push_back({6, Index(25 + Adjacency(grid(4, 4)).edgeBetween(6, 7)), 1});
    EXPECT_THAT(complaint(halfCrease), HasSubstr("a crease ends at vertex"));
    PolygonMesh across = subdivided(grid(4, 4), scheme(), 1);
    const auto face = across.face(0);
    across.creases.push_back({face[1], face[2], 1});
    EXPECT_THAT(complaint(across), HasSubstr("would run across a face"));
    PolygonMesh pinned = subdivided(grid(4, 4), scheme(), 1);
    pinned.pinned = {pinned.face(0)[2]};
    EXPECT_THAT(complaint(pinned), HasSubstr("marked corner"));
    // One component of two is not subdivided: named by its own vertices.
    const PolygonMesh mixed = together(subdivided(octahedron(), scheme(), 1), cube(), {5, 0, 0});
    EXPECT_THAT(complaint(mixed), HasSubstr("vertex 33"));
}

TEST(QuadConnectivity, NamesVerticesOfTheFileAtEveryLevel) {
    const PolygonMesh once = subdivided(grid(3, 3), scheme(), 1);
    const PolygonMesh fine = shuffled(once, 16);
    const std::string line = complaint(fine, 2);
    EXPECT_THAT(line, HasSubstr("after 1, "));
    // Whatever vertex it names lies where a vertex of the 3 x 3 grid does.
    const auto at = line.find("vertex ");
    ASSERT_NE(at, std::string::npos) << line;
    const Index named = Index(std::stoul(line.substr(at + 7)));
    double nearest = 1;
    for (Index v = 0; v < 16; ++v) nearest = std::min(nearest, length(fine.points[named] - once.points[v]));
    EXPECT_LT(nearest, 1e-12) << line;
}

// Any quad mesh can be subdivided, so any face taken out of a subdivision must leave an answer or a reason.
TEST(QuadConnectivity, WithAFaceMissingIsAnsweredOrRefused) {
    const PolygonMesh fine = subdivided(cubeWithPyramid(), scheme(), 1);
    for (std::size_t gone = 0; gone < fine.faceCount(); ++gone) {
        PolygonMesh mesh;
        mesh.points = fine.points;
        for (std::size_t f = 0; f < fine.faceCount(); ++f)
            if (f != gone) mesh.addFace(fine.face(f));
        EXPECT_THAT(complaint(mesh), HasSubstr("no Catmull-Clark connectivity: vertex")) << gone;
    }
}

}  // namespace
}  // namespace isowave::subdivision
