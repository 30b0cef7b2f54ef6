#include "lod/regions/far_places.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace isowave::lod {
namespace {

openvdb::Vec3d vec(const Point& p) { return {p[0], p[1], p[2]}; }

// Asks for distances to a surface, of one sample after another near it: where the last one's nearest triangle is near enough
// nothing is searched.
class Asker {
  public:
    Asker(const TriangleHierarchy* target, double limit, bool howFar, SampledSurface::Far& far)
        : target_(target), limit2_(limit * limit), howFar_(howFar), far_(far) {}

    void ask(const openvdb::Vec3d& p) {
        if (!target_) {
            far_.largest = HUGE_VAL;
            far_.places.push_back({{p.x(), p.y(), p.z()}, HUGE_VAL});
            return;
        }
        TriangleHierarchy::Nearest found{howFar_ ? HUGE_VAL : limit2_, -1};
        if (last_ >= 0) {
            const TriangleHierarchy::Nearest hint = target_->distanceTo(last_, p);
            if (hint.squared < found.squared) found = hint;
        }
        const bool isKnown = !howFar_ && found.triangle >= 0;
        if (!isKnown) found = target_->nearest(p, found);
        if (found.triangle >= 0) last_ = found.triangle;
        const double distance = howFar_ ? std::sqrt(found.squared) : HUGE_VAL;
        if (howFar_) far_.largest = std::max(far_.largest, distance);
        if (found.triangle < 0 || found.squared > limit2_)
            far_.places.push_back({{p.x(), p.y(), p.z()}, distance});
    }

  private:
    const TriangleHierarchy* target_;
    double limit2_;
    bool howFar_;
    SampledSurface::Far& far_;
    std::int64_t last_ = -1;
};

// visit(middle) for the n^2 equal parts of a triangle: (i, j) is a + i u + j v, u and v an n-th of two sides.
template <class Visit>
void forParts(const openvdb::Vec3d& a, const openvdb::Vec3d& b, const openvdb::Vec3d& c, int n,
              const Visit& visit) {
    const openvdb::Vec3d u = (b - a) / n, v = (c - a) / n;
    for (int i = 0; i < n; ++i)
        for (int j = 0; i + j < n; ++j) {
            const openvdb::Vec3d corner = a + i * u + j * v;
            visit(corner + (u + v) / 3);
            if (i + j + 1 < n) visit(corner + 2 * (u + v) / 3);
        }
}

int partsOf(const openvdb::Vec3d& a, const openvdb::Vec3d& b, const openvdb::Vec3d& c, double spacing) {
    constexpr double kMost = 4096;  // along a side: of a triangle that is as large as the solid
    const double longest =
        std::sqrt(std::max({(b - a).lengthSqr(), (c - b).lengthSqr(), (a - c).lengthSqr()}));
    return static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, kMost));
}

}  // namespace

SampledSurface::SampledSurface(const TriangleMesh& mesh, double spacing)
    : points_(mesh.points), triangles_(mesh.triangles), spacing_(spacing) {
    if (triangles_.empty()) return;
    std::vector<openvdb::Vec3d> corners;
    corners.reserve(points_.size());
    for (const Point& p : points_) corners.push_back(vec(p));
    hierarchy_.emplace(corners, triangles_);
}

bool SampledSurface::isNear(const Point& point, double limit) const {
    return hierarchy_ && hierarchy_->nearest(vec(point), {limit * limit, -1}).triangle >= 0;
}

SampledSurface::Far SampledSurface::farFrom(const SampledSurface& other, double limit, bool howFar,
                                            const Progress& progress) const {
    constexpr std::size_t kChunk = 1024;
    if (empty()) return {};
    const std::size_t count = points_.size() + triangles_.size();
    std::vector<Far> found((count + kChunk - 1) / kChunk);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
        progress.check();
        Asker asker(other.hierarchy_ ? &*other.hierarchy_ : nullptr, limit, howFar, found[chunk]);
        for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
            if (i < points_.size()) {
                asker.ask(vec(points_[i]));
                continue;
            }
            const Triangle& t = triangles_[i - points_.size()];
            const openvdb::Vec3d a = vec(points_[t[0]]), b = vec(points_[t[1]]), c = vec(points_[t[2]]);
            forParts(a, b, c, partsOf(a, b, c, spacing_), [&](const openvdb::Vec3d& p) { asker.ask(p); });
        }
    });
    Far all;
    for (const Far& part : found) {
        all.largest = std::max(all.largest, part.largest);
        all.places.insert(all.places.end(), part.places.begin(), part.places.end());
    }
    return all;
}

}  // namespace isowave::lod
