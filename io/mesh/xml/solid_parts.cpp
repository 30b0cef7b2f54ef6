#include "io/mesh/xml/solid_parts.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "io/mesh/float32.h"

namespace isowave {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct Shells {
    std::vector<std::uint32_t> ofTriangle;
    std::size_t count = 0;
};

Shells shellsOf(std::size_t pointCount, std::span<const Triangle> triangles) {
    DisjointSets sets(pointCount);
    for (const Triangle& t : triangles) sets.join(t[0], t[1]), sets.join(t[0], t[2]);
    Shells shells;
    std::vector<std::uint32_t> number(pointCount, kNone);
    for (const Triangle& t : triangles) {
        std::uint32_t& n = number[sets.of(t[0])];
        if (n == kNone) n = static_cast<std::uint32_t>(shells.count++);
        shells.ofTriangle.push_back(n);
    }
    return shells;
}

// Whether p, seen along x, is to the left of the line from u to v. The two directions of an edge always have different answers, and a
// point on the line is to the left of the direction of growing (y, z): as if p were moved a little, by the same for all lines.
bool isLeft(const Point& p, const Point& u, const Point& v) {
    const auto turn = [&](const Point& from, const Point& to) {
        return (to[1] - from[1]) * (p[2] - from[2]) - (to[2] - from[2]) * (p[1] - from[1]);
    };
    return std::pair(u[1], u[2]) < std::pair(v[1], v[2]) ? turn(u, v) >= 0 : turn(v, u) < 0;
}

// Whether the ray from p along +x passes through the triangle; through the edges and corners of a closed surface, too, it passes
// consistently.
bool isMet(const Point& p, const Point& a, const Point& b, const Point& c) {
    for (const std::size_t axis : {1, 2}) {
        const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
        if (p[axis] < low || p[axis] > high) return false;
    }
    const auto side = [&](const Point& u, const Point& v) { return isLeft(p, u, v); };
    const bool ab = side(a, b);
    if (side(b, c) != ab || side(c, a) != ab) return false;
    const Vec3 normal = cross(toVec3(b) - toVec3(a), toVec3(c) - toVec3(a));
    if (normal.x == 0) return false;
    const Vec3 to = toVec3(a) - toVec3(p);
    return dot(normal, to) / normal.x > 0;
}

class Parts {
  public:
    Parts(std::span<const Point> points, std::span<const Triangle> triangles)
        : points_(points), triangles_(triangles), shells_(shellsOf(points.size(), triangles)) {
        volume_.resize(shells_.count);
        first_.resize(shells_.count, kNone);
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            const std::uint32_t shell = shells_.ofTriangle[t];
            if (first_[shell] == kNone) first_[shell] = t;
            volume_[shell] += volumeOf(t);
        }
    }

    std::vector<std::vector<Triangle>> make() const {
        std::vector<std::uint32_t> owner(shells_.count), part(shells_.count, kNone);
        for (std::uint32_t s = 0; s < shells_.count; ++s) owner[s] = volume_[s] < 0 ? ownerOf(s) : s;
        std::vector<std::vector<Triangle>> parts;
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            std::uint32_t& number = part[owner[shells_.ofTriangle[t]]];
            if (number == kNone) {
                number = static_cast<std::uint32_t>(parts.size());
                parts.emplace_back();
            }
            parts[number].push_back(triangles_[t]);
        }
        return parts;
    }

  private:
    // Of the tetrahedron with the shell's first point: digits are not lost to a far origin.
    double volumeOf(std::uint32_t t) const {
        const Vec3 origin = toVec3(points_[triangles_[first_[shells_.ofTriangle[t]]][0]]);
        const auto corner = [&](int i) { return toVec3(points_[triangles_[t][i]]) - origin; };
        return dot(corner(0), cross(corner(1), corner(2))) / 6;
    }

    // The smallest outer shell around a cavity; itself where there is none.
    std::uint32_t ownerOf(std::uint32_t cavity) const {
        const std::vector<std::uint32_t> outer = outerShells();
        if (outer.size() == 1) return outer[0];
        const Point& p = points_[triangles_[first_[cavity]][0]];
        std::vector<bool> odd(shells_.count);
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            const auto& [a, b, c] = triangles_[t];
            const std::uint32_t shell = shells_.ofTriangle[t];
            if (volume_[shell] >= 0 && isMet(p, points_[a], points_[b], points_[c])) odd[shell].flip();
        }
        std::uint32_t smallest = cavity;
        for (const std::uint32_t s : outer)
            if (odd[s] && (smallest == cavity || volume_[s] < volume_[smallest])) smallest = s;
        return smallest;
    }

    std::vector<std::uint32_t> outerShells() const {
        std::vector<std::uint32_t> outer;
        for (std::uint32_t s = 0; s < shells_.count; ++s)
            if (volume_[s] >= 0) outer.push_back(s);
        return outer;
    }

    std::span<const Point> points_;
    std::span<const Triangle> triangles_;
    Shells shells_;
    std::vector<double> volume_;
    std::vector<std::uint32_t> first_;  // triangle of each shell
};

}  // namespace

std::vector<std::vector<Triangle>> solidParts(std::span<const Point> points,
                                              std::span<const Triangle> triangles) {
    return Parts(points, triangles).make();
}

}  // namespace isowave
