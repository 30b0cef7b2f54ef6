// Notation: corners p_0 .. p_{n-1}; W(i, j), i < j, the least weight of the polygon p_i .. p_j, whose side p_j p_i is a chord:
//   W(i, i+1) = 0,   W(i, j) = min over i < k < j of  W(i, k) + W(k, j) + weight(i, k, j).
#include "base/polygon_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/triangle.h"

namespace isowave {
namespace {

using Corner = std::uint32_t;
using Triples = std::vector<std::array<Corner, 3>>;

constexpr std::size_t kMostByWeight = 200;
constexpr std::size_t kMostByEars = 4'000;

class Polygon {
  public:
    explicit Polygon(std::span<const Point> points) : points_(points) {
        const Vec3 from = at(0);
        for (Corner i = 2; i < points.size(); ++i) normal_ += cross(at(i - 1) - from, at(i) - from);
    }

    Triples triangles() {
        std::vector<Corner> all(points_.size());
        for (Corner i = 0; i < all.size(); ++i) all[i] = i;
        if (isFan())
            fan();
        else
            cut(all);
        return std::move(found_);
    }

  private:
    Vec3 at(Corner i) const { return toVec3(points_[i]); }
    Vec3 twiceArea(Corner a, Corner b, Corner c) const { return cross(at(b) - at(a), at(c) - at(a)); }

    bool isFan() const {
        const double least = -1e-12 * dot(normal_, normal_);
        for (Corner i = 2; i < points_.size(); ++i)
            if (dot(twiceArea(0, i - 1, i), normal_) < least) return false;
        return points_.size() < 4 || length(normal_) > 0;
    }
    void fan() {
        for (Corner i = 2; i < points_.size(); ++i) found_.push_back({0, i - 1, i});
    }

    void cut(const std::vector<Corner>& corners) {
        if (corners.size() < 3) return;
        if (corners.size() <= kMostByWeight) return cutByWeight(corners);
        if (corners.size() <= kMostByEars && isPlanar(corners)) return cutEars(corners);
        cutInTwo(corners);
    }

    // ---- least area

    // Among triangulations of the same area short edges win; 1e-6 of their squares outweighs no real difference.
    double weight(Corner a, Corner b, Corner c) const {
        const Vec3 u = at(b) - at(a), v = at(c) - at(b), w = at(a) - at(c);
        return length(cross(u, v)) / 2 + 1e-6 * (dot(u, u) + dot(v, v) + dot(w, w));
    }
    void cutByWeight(const std::vector<Corner>& p) {
        const std::size_t n = p.size();
        std::vector<double> least(n * n, 0);
        std::vector<Corner> by(n * n, 0);
        for (std::size_t span = 2; span < n; ++span) {
            for (std::size_t i = 0; i + span < n; ++i) {
                const std::size_t j = i + span;
                double best = std::numeric_limits<double>::infinity();
                for (std::size_t k = i + 1; k < j; ++k) {
                    const double sum = least[i * n + k] + least[k * n + j] + weight(p[i], p[k], p[j]);
                    if (sum < best) best = sum, by[i * n + j] = static_cast<Corner>(k);
                }
                least[i * n + j] = best;
            }
        }
        std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
        while (!open.empty()) {
            const auto [i, j] = open.back();
            open.pop_back();
            if (j - i < 2) continue;
            const std::size_t k = by[i * n + j];
            found_.push_back({p[i], p[k], p[j]});
            open.push_back({i, k});
            open.push_back({k, j});
        }
    }

    // ---- ears

    // Farthest corner from the plane of the mean below 1 % of the square root of the area.
    bool isPlanar(const std::vector<Corner>& corners) const {
        const double twice = length(normal_);
        if (!(twice > 0)) return false;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const Corner c : corners) {
            const double height = dot(at(c), normal_) / twice;
            low = std::min(low, height);
            high = std::max(high, height);
        }
        return high - low < 0.01 * std::sqrt(twice / 2);
    }
    bool isConvex(Corner a, Corner b, Corner c) const { return dot(twiceArea(a, b, c), normal_) > 0; }
    bool holds(Corner a, Corner b, Corner c, Corner p) const {
        if (points_[p] == points_[a] || points_[p] == points_[b] || points_[p] == points_[c]) return false;
        return dot(twiceArea(a, b, p), normal_) >= 0 && dot(twiceArea(b, c, p), normal_) >= 0 &&
               dot(twiceArea(c, a, p), normal_) >= 0;
    }
    bool isEar(const std::vector<Corner>& p, std::size_t i) const {
        const std::size_t n = p.size();
        const Corner a = p[(i + n - 1) % n], b = p[i], c = p[(i + 1) % n];
        if (!isConvex(a, b, c)) return false;
        return std::none_of(p.begin(), p.end(), [&](Corner q) { return holds(a, b, c, q); });
    }
    // Walks on from the last ear, so that no corner becomes the apex of a fan. Where rounding leaves no ear the next corner
    // goes as if it were one.
    void cutEars(std::vector<Corner> p) {
        std::size_t i = 0;
        while (p.size() > 3) {
            std::size_t tried = 0;
            while (tried < p.size() && !isEar(p, i % p.size())) ++i, ++tried;
            i %= p.size();
            const std::size_t n = p.size();
            found_.push_back({p[(i + n - 1) % n], p[i], p[(i + 1) % n]});
            p.erase(p.begin() + static_cast<std::ptrdiff_t>(i));
            ++i;
        }
        found_.push_back({p[0], p[1], p[2]});
    }

    // ---- halves

    // Along the chord that is shortest beside the way round, of at most 2^22 that are looked at; at least a sixteenth of the
    // corners lie on either side.
    void cutInTwo(const std::vector<Corner>& p) {
        const std::size_t n = p.size(), stride = std::max<std::size_t>(1, n / 2048), least = n / 16;
        double best = std::numeric_limits<double>::infinity();
        std::size_t from = 0, to = n / 2;
        for (std::size_t i = 0; i < n; i += stride)
            for (std::size_t j = i + least; j < n && n - (j - i) >= least; j += stride) {
                const Vec3 chord = at(p[j]) - at(p[i]);
                if (const double square = dot(chord, chord); square < best) best = square, from = i, to = j;
            }
        const auto place = [&](std::size_t i) { return p.begin() + static_cast<std::ptrdiff_t>(i); };
        std::vector<Corner> inner(place(from), place(to) + 1), outer(place(to), p.end());
        outer.insert(outer.end(), p.begin(), place(from) + 1);
        cut(inner);
        cut(outer);
    }

    std::span<const Point> points_;
    Vec3 normal_;  // twice the vector area
    Triples found_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> trianglesOf(std::span<const Point> polygon) {
    return Polygon(polygon).triangles();
}

}  // namespace isowave
