#include "polygonize/topology.h"
#include "io/mesh/equal_points.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

namespace isowave {
namespace {

// A torus (genus 1) of n x m quadrilaterals, each cut in two, counter-clockwise from outside.
TriangleMesh torusMesh(std::uint32_t n, std::uint32_t m, const Point& centre = {0, 0, 0}) {
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < m; ++j) {
            const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m,
                         r = 3 + std::cos(b);
            mesh.points.push_back(
                {centre[0] + r * std::cos(a), centre[1] + r * std::sin(a), centre[2] + std::sin(b)});
        }
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return i % n * m + j % m; };
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < m; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

TriangleMesh tetrahedron(const Point& at = {0, 0, 0}, double size = 1) {
    TriangleMesh mesh;
    mesh.points = {
        at, {at[0] + size, at[1], at[2]}, {at[0], at[1] + size, at[2]}, {at[0], at[1], at[2] + size}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
    const auto base = static_cast<std::uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
    for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + base, b + base, c + base});
}

bool good(const MeshTopology& t) { return t.closed() && t.manifold() && t.oriented(); }

TEST(Topology, KnowsATetrahedron) {
    const MeshTopology t = topologyOf(tetrahedron());
    EXPECT_TRUE(good(t));
    EXPECT_EQ(t.components, 1);
    EXPECT_EQ(t.genus, 0);
    EXPECT_EQ(t.vertices, 4);
    EXPECT_EQ(t.each[0].edges, 6);
    EXPECT_NEAR(t.volume, 1.0 / 6, 1e-15);
    EXPECT_NEAR(t.area, 1.5 + std::sqrt(3) / 2, 1e-15);
}

TEST(Topology, MeasuresATorusAlsoFarFromTheOrigin) {
    const double exact = 2 * std::numbers::pi * std::numbers::pi * 3;
    for (const double far : {0.0, 1e6}) {
        const MeshTopology t = topologyOf(torusMesh(300, 200, {far, -far, far}));
        EXPECT_TRUE(good(t));
        EXPECT_EQ(t.genus, 1);
        EXPECT_EQ(t.each[0].euler, 0);
        EXPECT_NEAR(t.volume / exact, 1, 5e-4);
        EXPECT_NEAR(t.volume, topologyOf(torusMesh(300, 200)).volume, 1e-7);
    }
}

TEST(Topology, AddsUpComponentsLargestFirst) {
    TriangleMesh mesh = tetrahedron({10, 0, 0}, 0.5);
    append(mesh, torusMesh(30, 20));
    append(mesh, tetrahedron({20, 0, 0}, 2));
    append(mesh, tetrahedron({30, 0, 0}, 2));
    mesh.points.push_back({99, 99, 99});  // used by nothing
    const MeshTopology t = topologyOf(mesh);
    EXPECT_TRUE(good(t));
    ASSERT_EQ(t.components, 4);
    EXPECT_EQ(t.vertices, 4 * 3 + 600);
    EXPECT_EQ(t.genus, 1);
    EXPECT_EQ(t.each[0].triangles, 1200);
    EXPECT_NEAR(t.each[1].volume, 8.0 / 6, 1e-12);
    EXPECT_NEAR(t.each[2].volume, 8.0 / 6, 1e-12);
    EXPECT_NEAR(t.each[3].volume, 0.125 / 6, 1e-12);
}

TEST(Topology, SeesAMissingTriangle) {
    TriangleMesh mesh = torusMesh(10, 10);
    mesh.triangles.pop_back();
    const MeshTopology t = topologyOf(mesh);
    EXPECT_FALSE(t.closed());
    EXPECT_EQ(t.boundaryEdges, 3);
    EXPECT_TRUE(t.manifold());
    EXPECT_TRUE(t.oriented());
}

TEST(Topology, SeesATurnedTriangle) {
    TriangleMesh mesh = torusMesh(10, 10);
    std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
    const MeshTopology t = topologyOf(mesh);
    EXPECT_TRUE(t.closed());
    EXPECT_EQ(t.misorientedEdges, 3);
    EXPECT_FALSE(t.oriented());
}

TEST(Topology, SeesAnEdgeWithFourTriangles) {
    // Two tetrahedra that share the edge 0-1.
    TriangleMesh mesh = tetrahedron();
    append(mesh, tetrahedron({0, 0, 0}, -1));
    for (Triangle& t : mesh.triangles)
        for (auto& v : t) v = v == 4 ? 0 : v == 5 ? 1 : v;
    const MeshTopology t = topologyOf(mesh);
    EXPECT_EQ(t.nonManifoldEdges, 1);
    EXPECT_EQ(t.boundaryEdges, 0);
    EXPECT_EQ(t.components, 1);
    EXPECT_FALSE(t.manifold());
}

TEST(Topology, SeesTwoFansAtAVertex) {
    TriangleMesh mesh = tetrahedron();
    append(mesh, tetrahedron({0, 0, 0}, -1));
    for (Triangle& t : mesh.triangles)
        for (auto& v : t) v = v == 4 ? 0 : v;
    const MeshTopology t = topologyOf(mesh);
    EXPECT_EQ(t.nonManifoldVertices, 1);
    EXPECT_EQ(t.nonManifoldEdges, 0);
    EXPECT_TRUE(t.closed());
    EXPECT_FALSE(t.manifold());
    EXPECT_EQ(t.components, 1);
}

TEST(Topology, CountsDegenerateTrianglesAndLeavesThemOut) {
    TriangleMesh mesh = tetrahedron();
    mesh.triangles.push_back({0, 0, 1});
    mesh.points.push_back({5, 5, 5});
    mesh.triangles.push_back({4, 4, 4});
    const MeshTopology t = topologyOf(mesh);
    EXPECT_EQ(t.degenerateTriangles, 2);
    EXPECT_EQ(t.triangles, 6);
    EXPECT_EQ(t.vertices, 4);
    EXPECT_EQ(t.components, 1);
    EXPECT_TRUE(t.closed());
    EXPECT_FALSE(t.manifold());
}

TEST(Topology, SeesADoubledTriangle) {
    TriangleMesh mesh = tetrahedron();
    mesh.triangles.push_back(mesh.triangles[0]);
    EXPECT_EQ(topologyOf(mesh).nonManifoldEdges, 3);
}

TEST(Topology, OfNothingIsNothing) {
    const MeshTopology t = topologyOf({});
    EXPECT_FALSE(t.closed());
    EXPECT_EQ(t.components, 0);
}

TEST(Topology, OfAClosedMeshIsTheSameWithoutLookingAtStars) {
    TriangleMesh mesh = torusMesh(40, 20);
    append(mesh, torusMesh(30, 10, {20, 0, 0}));
    append(mesh, tetrahedron({-20, 0, 0}));
    std::swap(mesh.triangles.back()[0], mesh.triangles.back()[1]);  // inside out as a whole: a cavity
    for (std::size_t t = mesh.triangles.size() - 4; t + 1 < mesh.triangles.size(); ++t)
        std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    mesh.points.push_back({5, 5, 5});  // which no triangle uses
    const MeshTopology full = topologyOf(mesh), quick = closedTopologyOf(mesh);
    ASSERT_TRUE(full.closed());
    EXPECT_EQ(quick.parts, 2);
    EXPECT_EQ(quick.cavities, 1);
    EXPECT_EQ(quick.genus, 2);
    EXPECT_EQ(quick.vertices, full.vertices);
    EXPECT_EQ(quick.volume, full.volume);
    EXPECT_EQ(quick.area, full.area);
    ASSERT_EQ(quick.each.size(), full.each.size());
    for (std::size_t i = 0; i < full.each.size(); ++i) {
        EXPECT_EQ(quick.each[i].edges, full.each[i].edges);
        EXPECT_EQ(quick.each[i].euler, full.each[i].euler);
        EXPECT_EQ(quick.each[i].volume, full.each[i].volume);
    }
}

TEST(Topology, DoesNotDependOnThreads) {
    TriangleMesh mesh = torusMesh(700, 400);
    mesh.triangles.erase(mesh.triangles.begin() + 1000);
    MeshTopology first;
    for (const std::size_t threads : {1, 2, 4}) {
        tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const MeshTopology t = topologyOf(mesh);
        if (threads == 1) first = t;
        EXPECT_EQ(t.volume, first.volume);
        EXPECT_EQ(t.area, first.area);
        EXPECT_EQ(t.boundaryEdges, 3);
    }
}

TEST(MergeEqualPoints, GluesASoupBackTogetherInTheOrderOfFirstAppearance) {
    const TriangleMesh mesh = torusMesh(40, 30);
    TriangleMesh soup;
    for (const Triangle& t : mesh.triangles) {
        const auto base = static_cast<std::uint32_t>(soup.points.size());
        for (const std::uint32_t v : t) soup.points.push_back(mesh.points[v]);
        soup.triangles.push_back({base, base + 1, base + 2});
    }
    EXPECT_EQ(topologyOf(soup).boundaryEdges, 3 * 2400);
    const TriangleMesh merged = mergeEqualPoints(soup);
    EXPECT_EQ(merged.points.size(), 1200u);
    EXPECT_EQ(merged.points[0], soup.points[0]);
    EXPECT_EQ(merged.triangles[0], (Triangle{0, 1, 2}));
    EXPECT_TRUE(good(topologyOf(merged)));
    EXPECT_EQ(topologyOf(merged).genus, 1);
}

TEST(MergeEqualPoints, TakesMinusZeroForZeroAndKeepsNeighboursApart) {
    TriangleMesh mesh;
    mesh.points = {{0.0, 1, 2}, {-0.0, 1, 2}, {std::nextafter(0.0, 1.0), 1, 2}};
    mesh.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}};
    const TriangleMesh merged = mergeEqualPoints(mesh);
    EXPECT_EQ(merged.points.size(), 2u);
    EXPECT_EQ(merged.triangles[0], (Triangle{0, 0, 1}));
    EXPECT_EQ(merged.normals[1], (std::array<float, 3>{0, 0, 1}));
}

}  // namespace
}  // namespace isowave
