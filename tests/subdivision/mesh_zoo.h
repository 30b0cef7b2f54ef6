// Polygon meshes grouped by property, and what tests do to them.
#pragma once

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision::mesh_zoo {

inline PolygonMesh meshOf(std::vector<Vec3> points, const std::vector<std::vector<Index>>& faces) {
    PolygonMesh mesh;
    mesh.points = std::move(points);
    for (const auto& face : faces) mesh.addFace(face);
    return mesh;
}

inline PolygonMesh cube() {
    return meshOf(
        {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}},
        {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
}

inline PolygonMesh tetrahedron() {
    return meshOf({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                  {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
}

inline PolygonMesh octahedron() {
    return meshOf({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                  {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

// A base of n corners and a copy of it above (prism), or a tip (pyramid).
inline PolygonMesh prism(Index n, double height = 1.3) {
    PolygonMesh mesh;
    for (const double z : {0.0, height}) {
        for (Index i = 0; i < n; ++i) {
            const double a = 2 * std::numbers::pi * i / n;
            mesh.points.push_back({std::cos(a), std::sin(a), z});
        }
    }
    std::vector<Index> bottom, top;
    for (Index i = 0; i < n; ++i) {
        bottom.push_back(n - 1 - i);
        top.push_back(n + i);
    }
    mesh.addFace(bottom);
    mesh.addFace(top);
    for (Index i = 0; i < n; ++i) mesh.addFace({i, (i + 1) % n, n + (i + 1) % n, n + i});
    return mesh;
}

inline PolygonMesh pyramid(Index n) {
    PolygonMesh mesh;
    std::vector<Index> bottom;
    for (Index i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * i / n;
        mesh.points.push_back({std::cos(a), std::sin(a), 0});
        bottom.push_back(n - 1 - i);
    }
    mesh.points.push_back({0.1, 0.2, 1.5});
    mesh.addFace(bottom);
    for (Index i = 0; i < n; ++i) mesh.addFace({i, (i + 1) % n, n});
    return mesh;
}

// Four valence-3 vertices at the far end of a cube whose near face carries a pyramid.
inline PolygonMesh cubeWithPyramid() {
    PolygonMesh mesh;
    const PolygonMesh box = cube();
    mesh.points = box.points;
    for (std::size_t f = 0; f < box.faceCount(); ++f)
        if (f != 1) mesh.addFace(box.face(f));
    mesh.points.push_back({0.2, 0.1, 2.2});
    for (Index i = 0; i < 4; ++i) mesh.addFace({4 + i, 4 + (i + 1) % 4, 8});
    return mesh;
}

// Quads, m x n of them; height of a node by f(i, j).
template <class F>
PolygonMesh grid(Index m, Index n, F f) {
    PolygonMesh mesh;
    for (Index j = 0; j <= n; ++j)
        for (Index i = 0; i <= m; ++i) mesh.points.push_back({double(i), double(j), f(i, j)});
    const auto at = [&](Index i, Index j) { return j * (m + 1) + i; };
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < m; ++i) mesh.addFace({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    return mesh;
}
inline PolygonMesh grid(Index m, Index n) {
    return grid(m, n, [](Index i, Index j) { return 0.3 * std::sin(1.7 * i + 0.9 * j); });
}

inline PolygonMesh torus(Index m, Index n, double R = 2, double r = 0.8) {
    PolygonMesh mesh;
    for (Index j = 0; j < n; ++j) {
        for (Index i = 0; i < m; ++i) {
            const double a = 2 * std::numbers::pi * i / m, b = 2 * std::numbers::pi * j / n;
            mesh.points.push_back(
                {(R + r * std::cos(b)) * std::cos(a), (R + r * std::cos(b)) * std::sin(a), r * std::sin(b)});
        }
    }
    const auto at = [&](Index i, Index j) { return j % n * m + i % m; };
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < m; ++i) mesh.addFace({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    return mesh;
}

// A strip closed to a ring: two boundaries, no corner.
inline PolygonMesh cylinder(Index m, Index n) {
    PolygonMesh mesh;
    for (Index j = 0; j <= n; ++j) {
        for (Index i = 0; i < m; ++i) {
            const double a = 2 * std::numbers::pi * i / m;
            mesh.points.push_back({std::cos(a), std::sin(a), 0.5 * j});
        }
    }
    const auto at = [&](Index i, Index j) { return j * m + i % m; };
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < m; ++i) mesh.addFace({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    return mesh;
}

// The boundary of a plate of unit cubes with a hole for each '.': valences 3, 4, 5 and 6.
inline PolygonMesh plate(const std::vector<std::string>& rows) {
    const auto full = [&](int x, int y, int z) {
        return z == 0 && y >= 0 && y < int(rows.size()) && x >= 0 && x < int(rows[y].size()) &&
               rows[y][x] == '#';
    };
    PolygonMesh mesh;
    std::map<std::array<int, 3>, Index> index;
    const auto vertex = [&](int x, int y, int z) {
        const auto [at, added] = index.emplace(std::array<int, 3>{x, y, z}, Index(mesh.points.size()));
        if (added) mesh.points.push_back({double(x), double(y), double(z)});
        return at->second;
    };
    for (int y = 0; y < int(rows.size()); ++y) {
        for (int x = 0; x < int(rows[y].size()); ++x) {
            if (!full(x, y, 0)) continue;
            const auto v = [&](int i, int j, int k) { return vertex(x + i, y + j, k); };
            mesh.addFace({v(0, 0, 0), v(0, 1, 0), v(1, 1, 0), v(1, 0, 0)});
            mesh.addFace({v(0, 0, 1), v(1, 0, 1), v(1, 1, 1), v(0, 1, 1)});
            if (!full(x, y - 1, 0)) mesh.addFace({v(0, 0, 0), v(1, 0, 0), v(1, 0, 1), v(0, 0, 1)});
            if (!full(x, y + 1, 0)) mesh.addFace({v(0, 1, 0), v(0, 1, 1), v(1, 1, 1), v(1, 1, 0)});
            if (!full(x - 1, y, 0)) mesh.addFace({v(0, 0, 0), v(0, 0, 1), v(0, 1, 1), v(0, 1, 0)});
            if (!full(x + 1, y, 0)) mesh.addFace({v(1, 0, 0), v(1, 1, 0), v(1, 1, 1), v(1, 0, 1)});
        }
    }
    return mesh;
}
inline PolygonMesh genusTwo() { return plate({"#####", "#.#.#", "#####"}); }

inline PolygonMesh together(const PolygonMesh& a, const PolygonMesh& b, const Vec3& move) {
    PolygonMesh mesh = a;
    const auto shift = static_cast<Index>(a.vertexCount());
    for (const Vec3& p : b.points) mesh.points.push_back(p + move);
    for (std::size_t f = 0; f < b.faceCount(); ++f) {
        std::vector<Index> face(b.face(f).begin(), b.face(f).end());
        for (Index& v : face) v += shift;
        mesh.addFace(face);
    }
    for (const Crease& c : b.creases) mesh.creases.push_back({c.a + shift, c.b + shift, c.sharpness});
    for (const Index v : b.pinned) mesh.pinned.push_back(v + shift);
    return mesh;
}

inline PolygonMesh creased(PolygonMesh mesh, const std::vector<std::pair<Index, Index>>& edges,
                           std::vector<Index> pinned = {}) {
    for (const auto& [a, b] : edges) mesh.creases.push_back({a, b, 2.5});
    mesh.pinned = std::move(pinned);
    return mesh;
}

struct Shape {
    std::string name;
    PolygonMesh mesh;
};

// Those of which P is injective: a base is found again whatever its points are.
inline std::vector<Shape> injective() {
    return {
        {"torus", torus(6, 5)},
        {"octahedron", octahedron()},
        {"pyramid of 4", pyramid(4)},
        {"pyramid of 5", pyramid(5)},
        {"tetrahedron", tetrahedron()},  // valence 3 only, odd cycles
        {"prism of 3", prism(3)},
        {"prism of 5", prism(5)},
        {"grid 1x1", grid(1, 1)},
        {"grid 3x3", grid(3, 3)},
        {"grid 5x4", grid(5, 4)},
        {"one pentagon", meshOf({{0, 0, 0}, {2, 0, 0}, {3, 1, 1}, {1, 2, 0}, {-1, 1, 0}}, {{0, 1, 2, 3, 4}})},
        {"cylinder", cylinder(5, 3)},
        {"cube with a pyramid", cubeWithPyramid()},
        {"two components", together(octahedron(), grid(2, 3), {5, 0, 0})},
        {"genus 2", genusTwo()},
        {"cube with a creased face", creased(cube(), {{4, 5}, {5, 6}, {6, 7}, {7, 4}})},
        {"cube with all edges sharp", creased(cube(), {{0, 1},
                                                       {1, 2},
                                                       {2, 3},
                                                       {3, 0},
                                                       {4, 5},
                                                       {5, 6},
                                                       {6, 7},
                                                       {7, 4},
                                                       {0, 4},
                                                       {1, 5},
                                                       {2, 6},
                                                       {3, 7}})},
        {"grid with a crease to its middle", creased(grid(4, 4), {{10, 11}, {11, 12}})},
        {"torus with a pinned vertex", creased(torus(4, 4), {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, {6})},
    };
}

// Valence 3 only and no odd cycle: +-1 alternating is in the kernel of P.
inline std::vector<Shape> ambiguous() {
    return {{"cube", cube()},
            {"prism of 6", prism(6)},
            {"cube with one sharp edge", creased(cube(), {{0, 1}})},
            {"cube beside a torus", together(cube(), torus(5, 4), {6, 0, 0})}};
}

inline std::vector<Shape> all() {
    auto shapes = injective();
    for (auto& shape : ambiguous()) shapes.push_back(std::move(shape));
    return shapes;
}

// Numbers in [-1, 1], the same everywhere (std::uniform_real_distribution is not).
class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double operator()() { return double(engine_()) / 2147483647.5 - 1; }
    Vec3 vector() { return {(*this)(), (*this)(), (*this)()}; }
    std::vector<Vec3> vectors(std::size_t n) {
        std::vector<Vec3> result(n);
        for (Vec3& v : result) v = vector();
        return result;
    }
    template <class T>
    void shuffle(std::vector<T>& list) {
        for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[engine_() % i]);
    }
    Index below(std::size_t n) { return static_cast<Index>(engine_() % n); }

  private:
    std::mt19937 engine_;
};

// The same mesh with its vertices and faces in another order, faces starting at other corners.
inline PolygonMesh shuffled(const PolygonMesh& mesh, unsigned seed) {
    Random random(seed);
    std::vector<Index> vertex(mesh.vertexCount()), face(mesh.faceCount());
    std::iota(vertex.begin(), vertex.end(), Index{0});
    std::iota(face.begin(), face.end(), Index{0});
    random.shuffle(vertex);
    random.shuffle(face);
    PolygonMesh result;
    result.points.resize(mesh.vertexCount());
    for (std::size_t v = 0; v < vertex.size(); ++v) result.points[vertex[v]] = mesh.points[v];
    for (const Index f : face) {
        std::vector<Index> corners;
        for (const Index v : mesh.face(f)) corners.push_back(vertex[v]);
        std::rotate(corners.begin(), corners.begin() + random.below(corners.size()), corners.end());
        result.addFace(corners);
    }
    for (const Crease& c : mesh.creases) result.creases.push_back({vertex[c.a], vertex[c.b], c.sharpness});
    for (const Index v : mesh.pinned) result.pinned.push_back(vertex[v]);
    return result;
}

inline double largest(const std::vector<Vec3>& vectors) {
    double most = 0;
    for (const Vec3& v : vectors) most = std::max(most, length(v));
    return most;
}
inline double distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, length(a[i] - b[i]));
    return most;
}
// The largest distance of a point of `a` to the nearest one of `b`, for meshes whose order differs.
inline double distanceAsSets(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double most = 0;
    for (const Vec3& p : a) {
        double least = std::numeric_limits<double>::infinity();
        for (const Vec3& q : b) least = std::min(least, length(p - q));
        most = std::max(most, least);
    }
    return most;
}

}  // namespace isowave::subdivision::mesh_zoo
