// Small meshes whose measures are known, for the tests of simplify/distance.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "isowave/mesh.h"

namespace isowave::shapes {

inline Point operator+(const Point& a, const Point& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Point operator-(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double length(const Point& a) { return std::sqrt(dot(a, a)); }

inline TriangleMesh tetrahedron(double size, const Point& at = {0, 0, 0}) {
    TriangleMesh mesh;
    mesh.points = {at, at + Point{size, 0, 0}, at + Point{0, size, 0}, at + Point{0, 0, size}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

inline TriangleMesh icosahedron() {
    const double g = (1 + std::sqrt(5.0)) / 2;
    TriangleMesh mesh;
    mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    return mesh;
}

// 20 * 4^level triangles, corners on the sphere.
inline TriangleMesh sphere(double radius, int level, const Point& centre = {0, 0, 0}) {
    TriangleMesh mesh = icosahedron();
    for (int l = 0; l < level; ++l) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), mesh.points.size());
            if (isNew) mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
            return at->second;
        };
        std::vector<Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (Point& p : mesh.points) p = centre + (radius / length(p)) * p;
    return mesh;
}

inline TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh mesh = a;
    const auto offset = static_cast<std::uint32_t>(a.points.size());
    mesh.points.insert(mesh.points.end(), b.points.begin(), b.points.end());
    for (const Triangle& t : b.triangles)
        mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    return mesh;
}

// Triangles of all sizes and proportions, slivers too, anywhere in the unit cube.
inline TriangleMesh soup(int triangles, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto anywhere = [&] { return Point{unit(random), unit(random), unit(random)}; };
    TriangleMesh mesh;
    for (int i = 0; i < triangles; ++i) {
        const Point at = anywhere(), along = anywhere(),
                    aside = std::pow(10.0, -6 * unit(random)) * anywhere();
        const auto first = static_cast<std::uint32_t>(mesh.points.size());
        mesh.points.insert(mesh.points.end(),
                           {at, at + 0.3 * along, at + (0.3 * unit(random)) * along + aside});
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

}  // namespace isowave::shapes
