// Small meshes, each with something that a walk over triangles may stumble over.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "isowave/mesh.h"

namespace isowave::view {

inline std::uint32_t index(int i) { return static_cast<std::uint32_t>(i); }

// A torus of n x m quadrilaterals, radii 3 and 1, closed, with one handle.
inline TriangleMesh torus(int n, int m) {
    TriangleMesh mesh;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) {
            const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / m;
            mesh.points.push_back(
                {(3 + std::cos(v)) * std::cos(u), (3 + std::cos(v)) * std::sin(u), std::sin(v)});
            const std::uint32_t a = index(i * m + j), b = index((i + 1) % n * m + j);
            const std::uint32_t c = index((i + 1) % n * m + (j + 1) % m), d = index(i * m + (j + 1) % m);
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

// n x n squares in the plane z = height: a border all around.
inline TriangleMesh sheet(int n, double height = 0) {
    TriangleMesh mesh;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) mesh.points.push_back({double(i), double(j), height});
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const std::uint32_t a = index(i * (n + 1) + j), b = index((i + 1) * (n + 1) + j);
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    return mesh;
}

inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
    const auto shift = static_cast<std::uint32_t>(a.points.size());
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    return a;
}

// Three triangles on one edge, two of them turned alike.
inline TriangleMesh fan() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}, {}};
}

// Every second triangle of a torus turned inside out: no two neighbours agree.
inline TriangleMesh misoriented() {
    TriangleMesh mesh = torus(8, 6);
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 2)
        std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    return mesh;
}

// A triangle without area by its indices, the same triangle twice, and points that none uses.
inline TriangleMesh oddities() {
    return {{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}},
            {{1, 2, 3}, {1, 2, 3}, {2, 2, 3}, {3, 2, 1}, {1, 1, 1}},
            {}};
}

struct NamedMesh {
    std::string name;
    TriangleMesh mesh;
};
inline std::vector<NamedMesh> zooOfMeshes() {
    return {{"torus", torus(24, 16)},
            {"sheet", sheet(7)},
            {"two tori", together(torus(9, 5), torus(5, 9))},
            {"fan", fan()},
            {"misoriented", misoriented()},
            {"oddities", oddities()},
            {"one triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}}},
            {"points in one place", {{{2, 2, 2}, {2, 2, 2}, {2, 2, 2}}, {{0, 1, 2}}, {}}}};
}

}  // namespace isowave::view
