// Limit positions: the masks against subdivision itself, which knows nothing of eigenvectors.
#include <gtest/gtest.h>

#include "isowave/error.h"
#include "subdivision/meshes/hierarchy.h"
#include "tests/subdivision/mesh_zoo.h"

namespace isowave::subdivision {
namespace {

using namespace mesh_zoo;

constexpr int kFewestEdges = 3, kMostEdges = 12;
constexpr int kTimes = 80;  // a step leaves at most 0.6 of the distance to the limit

// ---- meshes ----

// An n-gon of triangles around a tip, closed below by a flatter one: valences n, n and n times 4; or, as an open fan.
PolygonMesh spindle(Index n, bool open) {
    PolygonMesh mesh;
    for (Index i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * i / n;
        mesh.points.push_back({std::cos(a), 1.1 * std::sin(a), 0.2 * std::sin(3 * a + 1)});
    }
    mesh.points.push_back({0.2, 0.1, 1.2});
    for (Index i = 0; i < n; ++i) mesh.addFace({i, (i + 1) % n, n});
    if (open) return mesh;
    mesh.points.push_back({-0.1, 0.1, -0.7});
    for (Index i = 0; i < n; ++i) mesh.addFace({(i + 1) % n, i, n + 1});
    return mesh;
}

// Keeps the faces that lie around vertex v, and what subdivision makes of v's star next depends on nothing else.
PolygonMesh starOf(const PolygonMesh& mesh, Index v, Index& at) {
    std::map<Index, Index> number;
    PolygonMesh star;
    for (std::size_t f = 0; f < mesh.faceCount(); ++f) {
        const auto face = mesh.face(f);
        if (std::find(face.begin(), face.end(), v) == face.end()) continue;
        std::vector<Index> corners;
        for (const Index w : face) {
            if (number.emplace(w, star.vertexCount()).second) star.points.push_back(mesh.points[w]);
            corners.push_back(number[w]);
        }
        star.addFace(corners);
    }
    for (const Crease& c : mesh.creases)
        if ((c.a == v || c.b == v) && number.count(c.a) && number.count(c.b))
            star.creases.push_back({number[c.a], number[c.b], c.sharpness});
    for (const Index w : mesh.pinned)
        if (w == v) star.pinned.push_back(number[w]);
    at = number[v];
    return star;
}

// Where a vertex inside is after so many subdivisions of its star.
Vec3 subdividedFar(PolygonMesh mesh, Index v, const MeshScheme& scheme, int times) {
    for (int k = 0; k < times; ++k) {
        mesh = starOf(mesh, v, v);
        mesh = subdivided(mesh, scheme, 1);
    }
    return mesh.points[v];
}

double largestMove(const PolygonMesh& mesh, const MeshScheme& scheme) {
    return distance(limitPoints(mesh, scheme), mesh.points);
}

TEST(LimitPoints, AreWhereEightySubdivisionsOfAStarTakeItsVertexAtValencesFrom3To12) {
    for (const MeshScheme& scheme : meshSchemes()) {
        for (Index n = kFewestEdges; n <= kMostEdges; ++n) {
            const PolygonMesh mesh = spindle(n, /*open=*/true);
            const Vec3 limit = limitPoints(mesh, scheme)[n];
            EXPECT_LT(length(limit - subdividedFar(mesh, n, scheme, kTimes)), 1e-12)  // seen 2e-15
                << scheme.name << ", valence " << n;
        }
    }
}

TEST(LimitPoints, OfADartAreWhereSubdivisionOfItsStarTakesIt) {
    for (Index n = kFewestEdges; n <= kMostEdges; ++n) {
        const PolygonMesh mesh = creased(spindle(n, /*open=*/true), {{0, n}});
        const MeshScheme& scheme = meshScheme("catmull-clark");
        const Vec3 limit = limitPoints(mesh, scheme)[n];
        EXPECT_LT(length(limit - subdividedFar(mesh, n, scheme, kTimes)), 1e-12) << n;
        EXPECT_GT(length(limit - limitPoints(spindle(n, true), scheme)[n]), 1e-3) << n;
    }
}

TEST(LimitPoints, OfCreasesCornersAndPinnedVerticesAreWhereSubdivisionOfTheStarTakesThem) {
    const MeshScheme& scheme = meshScheme("catmull-clark");
    for (Index n = 4; n <= kMostEdges; ++n) {
        const PolygonMesh smooth = spindle(n, /*open=*/true);
        PolygonMesh pinned = smooth;
        pinned.pinned = {n};
        for (const PolygonMesh& mesh :
             {creased(smooth, {{0, n}, {2, n}}), creased(smooth, {{0, n}, {1, n}, {2, n}}), pinned}) {
            const Vec3 limit = limitPoints(mesh, scheme)[n];
            EXPECT_LT(length(limit - subdividedFar(mesh, n, scheme, kTimes)), 1e-12) << n;
        }
        EXPECT_EQ(limitPoints(pinned, scheme)[n], pinned.points[n]);
    }
}

// Every vertex of every shape, boundaries and polygons included: the whole mesh subdivided, nothing cut out.
TEST(LimitPoints, StayWhenTheMeshIsSubdividedAndDrawTheVerticesNear) {
    for (const auto& [shape, mesh] : all()) {
        for (const MeshScheme& scheme : meshSchemes()) {
            const bool triangles = scheme.name != "catmull-clark";
            if (triangles && mesh.corners.size() != 3 * mesh.faceCount()) continue;
            const auto limit = limitPoints(mesh, scheme);
            PolygonMesh fine = mesh;
            double before = distance(limit, mesh.points);
            for (int k = 0; k < 3; ++k) {
                fine = subdivided(fine, scheme, 1);
                auto again = limitPoints(fine, scheme);
                again.resize(mesh.vertexCount());
                EXPECT_LT(distance(again, limit), 1e-13) << shape << ", " << scheme.name;  // seen 2e-15
                std::vector<Vec3> points(fine.points.begin(), fine.points.begin() + mesh.vertexCount());
                const double now = distance(points, limit);
                EXPECT_LE(now, 0.8 * before + 1e-14) << shape << ", " << scheme.name;
                before = now;
            }
        }
    }
}

TEST(LimitPoints, OfAnOpenMeshAreWhereEightSubdivisionsTakeThem) {
    for (const MeshScheme& scheme : meshSchemes()) {
        const PolygonMesh mesh = spindle(5, /*open=*/true);
        PolygonMesh far = subdivided(mesh, scheme, 8);
        far.points.resize(mesh.vertexCount());
        EXPECT_LT(distance(far.points, limitPoints(mesh, scheme)), 1e-4) << scheme.name;
    }
}

TEST(LimitPoints, OfButterflyAreTheVerticesThemselves) {
    const PolygonMesh mesh = spindle(7, false);
    EXPECT_EQ(limitPoints(mesh, "butterfly"), mesh.points);
    EXPECT_GT(largestMove(mesh, meshScheme("loop")), 0.1);
}

TEST(LimitPoints, AreRefusedAsAnEditedBaseAndGivenForARebuiltMesh) {
    const PolygonMesh base = torus(6, 5);
    Hierarchy hierarchy =
        decompose(subdivided(base, meshScheme("catmull-clark"), 1), "catmull-clark", {.levels = 1});
    const auto limit = limitPoints(hierarchy.base, hierarchy.scheme);
    EXPECT_THROW(rebuild(hierarchy, {.moved = limit}), InputError);
    auto nearby = limit;
    nearby[0].x += 1e-3;
    EXPECT_NO_THROW(rebuild(hierarchy, {.moved = nearby}));
    const Rebuilt written = rebuild(hierarchy, {.positions = Positions::limit});
    EXPECT_EQ(written.report.positions, Positions::limit);
    EXPECT_EQ(written.mesh.points, limitPoints(reconstruct(hierarchy), hierarchy.scheme));
}

TEST(LimitPoints, RefuseADefectAndAnUnknownScheme) {
    PolygonMesh mesh = spindle(4, false);
    EXPECT_THROW(limitPoints(mesh, "cubic"), InputError);
    mesh.corners[0] = 99;
    EXPECT_THROW(limitPoints(mesh, "loop"), InputError);
    EXPECT_THROW(limitPoints(prism(5), "loop"), InputError);
}

}  // namespace
}  // namespace isowave::subdivision
