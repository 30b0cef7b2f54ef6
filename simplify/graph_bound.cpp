#include "simplify/graph_bound.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/triangle.h"

namespace isowave {
namespace {

constexpr std::size_t kMostVisited = 4000;  // triangles; a larger piece is better halved
constexpr double kFacing = 1e-3;            // the least cosine between the normals
constexpr double kRounding = 1e-12;         // of a piece's size

// Coordinates in the piece's plane, and the height over it.
struct Local {
    double x, y, height;
};

double cross2(const Local& a, const Local& b, const Local& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The piece as the triangle of its plane that it is.
class Column {
  public:
    explicit Column(const std::array<Vec3, 3>& piece) : origin_(piece[0]) {
        const Vec3 side = piece[1] - piece[0], normal = cross(side, piece[2] - piece[0]);
        const double size = length(side), area = length(normal);
        hasArea_ = size > 0 && area > 0;
        if (!hasArea_) return;
        x_ = (1 / size) * side;
        up_ = (1 / area) * normal;
        y_ = cross(up_, x_);
        for (std::size_t k = 0; k < 3; ++k) corners_[k] = at(piece[k]);
        margin_ = kRounding * area;
    }
    bool hasArea() const { return hasArea_; }
    Local at(const Vec3& p) const {
        const Vec3 from = p - origin_;
        return {dot(from, x_), dot(from, y_), dot(from, up_)};
    }
    // What of a convex polygon (a segment too) lies in the column, its border included. Sutherland and Hodgman 1974.
    std::vector<Local> cut(std::vector<Local> polygon) const {
        for (std::size_t k = 0; k < 3 && !polygon.empty(); ++k)
            polygon = cutBy(corners_[k], corners_[(k + 1) % 3], polygon);
        return polygon;
    }

  private:
    std::vector<Local> cutBy(const Local& a, const Local& b, const std::vector<Local>& polygon) const {
        std::vector<Local> inside;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Local &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double atP = cross2(a, b, p) + margin_, atQ = cross2(a, b, q) + margin_;
            if (atP >= 0) inside.push_back(p);
            if ((atP >= 0) == (atQ >= 0)) continue;
            const double t = atP / (atP - atQ);
            inside.push_back(
                {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.height + t * (q.height - p.height)});
        }
        return inside;
    }

    Vec3 origin_, x_, y_, up_;
    std::array<Local, 3> corners_{};
    double margin_ = 0;
    bool hasArea_ = false;
};

// Triangles in the order in which they were reached, each once.
class Reached {
  public:
    explicit Reached(std::uint32_t seed) : table_(64, kEmpty) { add(seed); }
    std::size_t size() const { return list_.size(); }
    std::uint32_t operator[](std::size_t i) const { return list_[i]; }
    void add(std::uint32_t triangle) {
        if (2 * list_.size() >= table_.size()) grow();
        if (enter(triangle)) list_.push_back(triangle);
    }

  private:
    static constexpr std::uint32_t kEmpty = ~std::uint32_t{0};
    bool enter(std::uint32_t triangle) {
        std::size_t slot = triangle * 0x9e3779b1u & (table_.size() - 1);
        while (table_[slot] != kEmpty) {
            if (table_[slot] == triangle) return false;
            slot = (slot + 1) & (table_.size() - 1);
        }
        table_[slot] = triangle;
        return true;
    }
    void grow() {
        table_.assign(2 * table_.size(), kEmpty);
        for (const std::uint32_t triangle : list_) enter(triangle);
    }
    std::vector<std::uint32_t> list_, table_;
};

bool faces(const std::array<Local, 3>& t) {
    const Vec3 u{t[1].x - t[0].x, t[1].y - t[0].y, t[1].height - t[0].height},
        v{t[2].x - t[0].x, t[2].y - t[0].y, t[2].height - t[0].height};
    return cross2(t[0], t[1], t[2]) > kFacing * length(cross(u, v));
}

}  // namespace

GraphBound::GraphBound(const TriangleMesh& mesh) : mesh_(mesh) {
    across_.assign(mesh.triangles.size(), {kNone, kNone, kNone});
    // Both ends, the smaller first; whether it runs from the larger; where it is.
    std::vector<std::tuple<std::uint32_t, std::uint32_t, bool, std::uint32_t, std::uint32_t>> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            sides.emplace_back(std::min(a, b), std::max(a, b), a > b, t, k);
        }
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
        const auto isSame = [&](const auto& side) {
            return std::get<0>(side) == std::get<0>(sides[i]) && std::get<1>(side) == std::get<1>(sides[i]);
        };
        for (end = i + 1; end < sides.size() && isSame(sides[end]);) ++end;
        if (end - i != 2 || std::get<2>(sides[i]) == std::get<2>(sides[i + 1])) continue;
        const auto& [a0, b0, back0, t0, k0] = sides[i];
        const auto& [a1, b1, back1, t1, k1] = sides[i + 1];
        across_[t0][k0] = t1;
        across_[t1][k1] = t0;
    }
}

std::optional<double> GraphBound::over(const std::array<Vec3, 3>& piece, std::uint32_t seed,
                                       double enough) const {
    const Column column(piece);
    if (!column.hasArea()) return {};
    Reached reached(seed);
    double largest = 0;
    bool isOver = false;
    for (std::size_t i = 0; i < reached.size(); ++i) {
        std::array<Local, 3> t;
        for (std::size_t k = 0; k < 3; ++k)
            t[k] = column.at(toVec3(mesh_.points[mesh_.triangles[reached[i]][k]]));
        const std::vector<Local> part = column.cut({t[0], t[1], t[2]});
        if (part.empty()) continue;
        isOver = true;
        for (const Local& corner : part) largest = std::max(largest, std::abs(corner.height));
        if (largest > enough || !faces(t)) return {};
        for (std::size_t k = 0; k < 3; ++k) {
            if (column.cut({t[k], t[(k + 1) % 3]}).empty()) continue;
            const std::uint32_t beyond = across_[reached[i]][k];
            if (beyond == kNone) return {};
            reached.add(beyond);
        }
        if (reached.size() > kMostVisited) return {};
    }
    return isOver ? std::optional(largest) : std::nullopt;
}

}  // namespace isowave
