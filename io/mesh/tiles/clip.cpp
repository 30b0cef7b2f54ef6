#include "io/mesh/tiles/clip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>

namespace isowave {
namespace {

__extension__ using Wide = __int128;

using Polygon = std::vector<std::uint32_t>;
using Cell = std::array<std::int32_t, 3>;

// a + (b - a) part / whole, rounded to the nearest, halves upwards. REQUIRES: 0 < part < whole.
std::int64_t between(std::int64_t a, std::int64_t b, std::int64_t part, std::int64_t whole) {
    const Wide twice = 2 * static_cast<Wide>(b - a) * part + whole, by = 2 * static_cast<Wide>(whole);
    Wide quotient = twice / by;
    if (twice % by < 0) --quotient;
    return a + static_cast<std::int64_t>(quotient);
}

class Clipper {
  public:
    Clipper(ClippedMesh& mesh, const TilePlanes& planes) : mesh_(mesh), planes_(planes) {}

    // invariant: all pieces of the polygon lie between the planes of `cell` on the axes before `axis`.
    void cut(Polygon polygon, std::size_t axis, Cell cell) {
        if (axis == 3) return emit(polygon, cell);
        std::int64_t low = at(polygon[0], axis), high = low;
        for (const std::uint32_t v : polygon) {
            low = std::min(low, at(v, axis));
            high = std::max(high, at(v, axis));
        }
        std::int64_t number = planes_.lastAtOrBelow(low);
        for (; planes_.at(number + 1) < high; ++number) {
            Polygon below = takeBelow(polygon, axis, planes_.at(number + 1));
            cell[axis] = static_cast<std::int32_t>(number);
            cut(std::move(below), axis + 1, cell);
        }
        cell[axis] = static_cast<std::int32_t>(number);
        cut(std::move(polygon), axis + 1, cell);
    }

  private:
    std::int64_t at(std::uint32_t v, std::size_t axis) const { return mesh_.points[v][axis]; }

    // Leaves what is above the plane. Along a polygon a coordinate rises once and falls once: edges of the triangle are monotone, and
    // so are the chords that planes before have cut, rounded or not; hence two pieces. Rounding may lay an edge into the plane on the
    // way from above to below: it stays above, and the cut begins at its end that is next to what is below.
    Polygon takeBelow(Polygon& polygon, std::size_t axis, std::int64_t plane) {
        Polygon below, above;
        const std::size_t n = polygon.size();
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t v = polygon[i], w = polygon[(i + 1) % n];
            const std::int64_t x = at(v, axis), y = at(w, axis), before = at(polygon[(i + n - 1) % n], axis);
            if (x < plane || (x == plane && (y < plane || before < plane))) below.push_back(v);
            if (x >= plane) above.push_back(v);
            if ((x < plane && y > plane) || (x > plane && y < plane)) {
                const std::uint32_t c = x < y ? crossing(v, w, axis, plane) : crossing(w, v, axis, plane);
                below.push_back(c);
                above.push_back(c);
            }
        }
        polygon = std::move(above);
        return below;
    }

    // Of the edge from v, below the plane, to w, above it. Planes come upwards, so an edge is cut once on an axis: what is left of
    // it has another end.
    std::uint32_t crossing(std::uint32_t v, std::uint32_t w, std::size_t axis, std::int64_t plane) {
        const std::uint64_t key = (static_cast<std::uint64_t>(std::min(v, w)) << 32) | std::max(v, w);
        std::optional<std::uint32_t>& known = crossings_[key][axis];
        if (!known) known = addCrossing(v, w, axis, plane);
        return *known;
    }
    std::uint32_t addCrossing(std::uint32_t v, std::uint32_t w, std::size_t axis, std::int64_t plane) {
        const LatticePoint a = mesh_.points[v], b = mesh_.points[w];
        const std::int64_t part = plane - a[axis], whole = b[axis] - a[axis];
        LatticePoint p{};
        for (std::size_t k = 0; k < 3; ++k) p[k] = k == axis ? plane : between(a[k], b[k], part, whole);
        mesh_.points.push_back(p);
        if (!mesh_.normals.empty())
            mesh_.normals.push_back(normalAt(v, w, static_cast<double>(part) / static_cast<double>(whole)));
        return static_cast<std::uint32_t>(mesh_.points.size() - 1);
    }
    std::array<float, 3> normalAt(std::uint32_t v, std::uint32_t w, double t) const {
        Vec3 n;
        for (int a = 0; a < 3; ++a) n[a] = (1 - t) * mesh_.normals[v][a] + t * mesh_.normals[w][a];
        const double size = length(n);
        if (size == 0) return mesh_.normals[v];
        return {static_cast<float>(n.x / size), static_cast<float>(n.y / size),
                static_cast<float>(n.z / size)};
    }

    double areaSquared(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
        Vec3 u, v;
        for (std::size_t k = 0; k < 3; ++k) {
            u[static_cast<int>(k)] = static_cast<double>(at(b, k) - at(a, k));
            v[static_cast<int>(k)] = static_cast<double>(at(c, k) - at(a, k));
        }
        const Vec3 n = cross(u, v);
        return dot(n, n);
    }
    // The fan whose smallest triangle is largest.
    std::size_t bestApex(const Polygon& polygon) const {
        std::size_t best = 0;
        double bestSmallest = -1;
        const std::size_t n = polygon.size();
        for (std::size_t apex = 0; apex < n; ++apex) {
            double smallest = std::numeric_limits<double>::infinity();
            for (std::size_t i = 1; i + 1 < n; ++i)
                smallest = std::min(smallest, areaSquared(polygon[apex], polygon[(apex + i) % n],
                                                          polygon[(apex + i + 1) % n]));
            if (smallest <= bestSmallest) continue;
            bestSmallest = smallest;
            best = apex;
        }
        return best;
    }
    void emit(const Polygon& polygon, const Cell& cell) {
        const std::size_t n = polygon.size(), apex = n == 3 ? 0 : bestApex(polygon);
        for (std::size_t i = 1; i + 1 < n; ++i) {
            mesh_.triangles.push_back({polygon[apex], polygon[(apex + i) % n], polygon[(apex + i + 1) % n]});
            mesh_.cells.push_back(cell);
        }
    }

    ClippedMesh& mesh_;
    const TilePlanes& planes_;
    // Of the edge's two ends, the smaller one in the upper half: what cuts it on each axis.
    std::unordered_map<std::uint64_t, std::array<std::optional<std::uint32_t>, 3>> crossings_;
};

// Steps from nearest to farthest, ties by x, y, z.
const std::vector<LatticePoint>& stepsOutwards() {
    static const std::vector<LatticePoint> steps = [] {
        constexpr std::int64_t kFar = 8;
        std::vector<LatticePoint> all;
        for (std::int64_t x = -kFar; x <= kFar; ++x)
            for (std::int64_t y = -kFar; y <= kFar; ++y)
                for (std::int64_t z = -kFar; z <= kFar; ++z)
                    if (x != 0 || y != 0 || z != 0) all.push_back({x, y, z});
        const auto far = [](const LatticePoint& p) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2]; };
        std::stable_sort(all.begin(), all.end(),
                         [&](const LatticePoint& a, const LatticePoint& b) { return far(a) < far(b); });
        return all;
    }();
    return steps;
}

// Whether a point may go from one to the other: it stays on the planes that it lies on, and between those that it lies between.
bool mayMove(const LatticePoint& from, const LatticePoint& to, const TilePlanes& planes) {
    for (std::size_t a = 0; a < 3; ++a) {
        if (from[a] == to[a]) continue;
        if (planes.isOn(from[a]) || planes.isOn(to[a])) return false;
        if (planes.lastAtOrBelow(from[a]) != planes.lastAtOrBelow(to[a])) return false;
    }
    return true;
}

}  // namespace

ClippedMesh clipToPlanes(std::vector<LatticePoint> points, std::vector<std::array<float, 3>> normals,
                         const std::vector<Triangle>& triangles, const TilePlanes& planes) {
    ClippedMesh mesh;
    mesh.points = std::move(points);
    mesh.normals = std::move(normals);
    mesh.triangles.reserve(triangles.size() + triangles.size() / 8);
    mesh.cells.reserve(mesh.triangles.capacity());
    keepApart(mesh.points, planes);
    Clipper clipper(mesh, planes);
    for (const Triangle& t : triangles) clipper.cut({t[0], t[1], t[2]}, 0, {});
    keepApart(mesh.points, planes);
    return mesh;
}

void keepApart(std::vector<LatticePoint>& points, const TilePlanes& planes) {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return points[a] != points[b] ? points[a] < points[b] : a < b;
    });
    std::vector<std::uint32_t> copies;
    for (std::size_t i = 1; i < order.size(); ++i)
        if (points[order[i]] == points[order[i - 1]]) copies.push_back(order[i]);
    if (copies.empty()) return;
    std::sort(copies.begin(), copies.end());
    std::set<LatticePoint> moved;
    // `order` stays sorted by where points were; a place that one has left is not taken again, for the first one is still there.
    const std::vector<LatticePoint> before = points;
    const auto isTaken = [&](const LatticePoint& p) {
        const auto found =
            std::lower_bound(order.begin(), order.end(), p,
                             [&](std::uint32_t v, const LatticePoint& wanted) { return before[v] < wanted; });
        return (found != order.end() && before[*found] == p) || moved.count(p) > 0;
    };
    for (const std::uint32_t v : copies) {
        for (const LatticePoint& step : stepsOutwards()) {
            const LatticePoint to{points[v][0] + step[0], points[v][1] + step[1], points[v][2] + step[2]};
            if (!mayMove(points[v], to, planes) || isTaken(to)) continue;
            points[v] = to;
            moved.insert(to);
            break;
        }
    }
}

bool zOrderLess(const TileIndex& a, const TileIndex& b) {
    // The axis whose highest differing bit is highest decides; of equal ones z, then y.
    std::size_t axis = 2;
    std::uint32_t most = 0;
    const auto bits = [](std::int32_t x) { return static_cast<std::uint32_t>(x) ^ 0x80000000u; };
    for (std::size_t k = 3; k-- > 0;) {
        const std::uint32_t differ = bits(a[k]) ^ bits(b[k]);
        if (most < differ && most < (most ^ differ)) {
            most = differ;
            axis = k;
        }
    }
    return bits(a[axis]) < bits(b[axis]);
}

std::vector<TileTriangles> tilesOf(const ClippedMesh& mesh, const TilePlanes& planes) {
    std::map<TileIndex, TileTriangles, decltype(&zOrderLess)> tiles(&zOrderLess);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Cell& cell = mesh.cells[t];
        const TileIndex at{planes.tileOf(cell[0]), planes.tileOf(cell[1]), planes.tileOf(cell[2])};
        TileTriangles& tile = tiles[at];
        tile.tile = at;
        tile.triangles.push_back(t);
        const int octant = (cell[0] & 1) | (cell[1] & 1) << 1 | (cell[2] & 1) << 2;
        if (planes.halves) tile.octants = static_cast<std::uint8_t>(tile.octants | 1 << octant);
    }
    std::vector<TileTriangles> all;
    for (auto& [at, tile] : tiles) all.push_back(std::move(tile));
    return all;
}

}  // namespace isowave
