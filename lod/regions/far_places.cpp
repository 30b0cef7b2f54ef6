#include "lod/regions/far_places.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace isowave::lod {
namespace {

openvdb::Vec3d vec(const Point& p) { return {p[0], p[1], p[2]}; }

using Nearest = TriangleHierarchy::Nearest;

// Asks for distances to a surface, of one sample after another near it: where the last one's nearest triangle is near enough
// nothing is searched.
class Asker {
  public:
    explicit Asker(const TriangleHierarchy& target) : target_(&target) {}

    // Whether a triangle is within the square root of `most`.
    bool isWithin(const openvdb::Vec3d& p, double most) {
        hint_ = last_ >= 0 ? target_->distanceTo(last_, p) : Nearest{HUGE_VAL, -1};
        if (hint_.squared < most) return true;
        const Nearest found = target_->nearest(p, {most, -1});
        if (found.triangle >= 0) last_ = found.triangle;
        return found.triangle >= 0;
    }
    // Of the point that isWithin() was called for last, squared.
    double toNearest(const openvdb::Vec3d& p) {
        const Nearest found = target_->nearest(p, hint_);
        last_ = found.triangle;
        return found.squared;
    }
    // What is known of all points between these: the distance to one triangle is a convex function, so where it is within the limit at
    // the corners it is so between them; and what is farther from the middle than the limit and the corners together is beyond it.
    // search: else only the last sample's triangle is tried.
    enum class All { near, far, unknown };
    All lookAt(std::span<const openvdb::Vec3d> corners, double most, bool search) {
        constexpr double kRounding =
            1e-9;  // nothing is decided here that a sample by itself would decide otherwise
        const auto isNearAll = [&](std::int64_t triangle) {
            return std::all_of(corners.begin(), corners.end(), [&](const openvdb::Vec3d& p) {
                return target_->distanceTo(triangle, p).squared < (1 - kRounding) * most;
            });
        };
        if (last_ >= 0 && isNearAll(last_)) return All::near;
        if (!search) return All::unknown;
        openvdb::Vec3d middle(0);
        for (const openvdb::Vec3d& p : corners) middle += p / static_cast<double>(corners.size());
        double radius2 = 0;
        for (const openvdb::Vec3d& p : corners) radius2 = std::max(radius2, (p - middle).lengthSqr());
        const double reach = (1 + kRounding) * (std::sqrt(most) + std::sqrt(radius2));
        const Nearest found = target_->nearest(middle, {reach * reach, -1});
        if (found.triangle < 0) return All::far;
        last_ = found.triangle;
        return isNearAll(last_) ? All::near : All::unknown;
    }

  private:
    const TriangleHierarchy* target_;
    std::int64_t last_ = -1;
    Nearest hint_{HUGE_VAL, -1};
};

// The n^2 equal parts of a triangle: (i, j) is a + i u + j v, u and v an n-th of two sides. Their middles, but for those in blocks that
// need no look.
template <class Ask>
class Parts {
  public:
    Parts(const openvdb::Vec3d& a, const openvdb::Vec3d& b, const openvdb::Vec3d& c, int n, Ask& ask)
        : a_(a), u_((b - a) / n), v_((c - a) / n), n_(n), ask_(ask) {}

    void visit() { visit({0, n_, 0, n_}); }

  private:
    using All = Asker::All;
    struct Block {
        int i, iEnd, j, jEnd;
        int size() const { return std::max(iEnd - i, jEnd - j); }
    };
    static constexpr int kLeaf = 2;    // parallelograms along a side
    static constexpr int kSearch = 4;  // along that of a block that is worth a search

    openvdb::Vec3d at(int i, int j) const { return a_ + i * u_ + j * v_; }

    // The corners of what of the block is in the triangle, i + j <= n.
    All look(const Block& b) const {
        const int iLow = std::min(b.iEnd, n_ - b.j),
                  jLow = std::min(b.jEnd, n_ - b.i);  // where j, i are least
        const int iHigh = std::min(b.iEnd, n_ - jLow), jHigh = std::min(b.jEnd, n_ - iLow);  // and most
        const bool isWhole = b.iEnd + b.jEnd <= n_;
        const openvdb::Vec3d corners[] = {at(b.i, b.j), at(iLow, b.j), at(b.i, jLow), at(iLow, jHigh),
                                          at(iHigh, jLow)};
        return ask_.lookAt({corners, isWhole ? std::size_t{4} : std::size_t{5}}, b.size() > kSearch);
    }
    void visit(const Block& b) {
        if (b.i + b.j >= n_) return;
        const All all = n_ > 1 ? look(b) : All::unknown;
        if (all == All::near) return;
        if (all == All::far || b.size() <= kLeaf) return visitAll(b, all == All::far);
        const int i = (b.i + b.iEnd) / 2, j = (b.j + b.jEnd) / 2;
        if (b.iEnd - b.i >= b.jEnd - b.j) {
            visit({b.i, i, b.j, b.jEnd});
            visit({i, b.iEnd, b.j, b.jEnd});
        } else {
            visit({b.i, b.iEnd, b.j, j});
            visit({b.i, b.iEnd, j, b.jEnd});
        }
    }
    void visitAll(const Block& b, bool isFar) {
        for (int i = b.i; i < b.iEnd; ++i)
            for (int j = b.j; j < b.jEnd && i + j < n_; ++j) {
                const openvdb::Vec3d corner = at(i, j);
                ask_(corner + (u_ + v_) / 3, isFar);
                if (i + j + 1 < n_) ask_(corner + 2 * (u_ + v_) / 3, isFar);
            }
    }

    const openvdb::Vec3d a_, u_, v_;
    const int n_;
    Ask& ask_;
};

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

namespace {

constexpr std::size_t kChunk = 1024;

using Corners = std::span<const openvdb::Vec3d>;
using All = Asker::All;

// What becomes of samples. (p, isFar) is called for one, isFar: it is known to be far; lookAt(corners) says what is known of all between
// them, and those that are near are passed over.
struct TakesAll {
    std::vector<FarPlace>& places;

    void operator()(const openvdb::Vec3d& p, bool) { places.push_back({{p.x(), p.y(), p.z()}, HUGE_VAL}); }
    All lookAt(Corners, bool) { return All::far; }
};

struct TakesFar {
    std::vector<FarPlace>& places;
    Asker asker;
    double limit2;
    bool howFar;

    void operator()(const openvdb::Vec3d& p, bool isFar) {
        if (isFar && !howFar) return places.push_back({{p.x(), p.y(), p.z()}, HUGE_VAL});
        if (asker.isWithin(p, limit2)) return;
        const double distance = howFar ? std::sqrt(asker.toNearest(p)) : HUGE_VAL;
        places.push_back({{p.x(), p.y(), p.z()}, distance});
    }
    All lookAt(Corners corners, bool search) { return asker.lookAt(corners, limit2, search); }
};

struct TakesFarthest {
    double& most2;
    Asker asker;

    void operator()(const openvdb::Vec3d& p, bool) {
        if (!asker.isWithin(p, most2)) most2 = std::max(most2, asker.toNearest(p));
    }
    All lookAt(Corners corners, bool search) { return asker.lookAt(corners, most2, search); }
};

}  // namespace

std::size_t SampledSurface::chunksOf(std::size_t begin, std::size_t end) const {
    return (end - begin + kChunk - 1) / kChunk;
}

template <class Ask>
void SampledSurface::forSamples(std::size_t begin, std::size_t end, const Progress& progress,
                                const Ask& asker) const {
    tbb::parallel_for(std::size_t{0}, chunksOf(begin, end), [&](std::size_t chunk) {
        progress.check();
        auto ask = asker(chunk);
        const std::size_t last = std::min(end, begin + (chunk + 1) * kChunk);
        for (std::size_t i = begin + chunk * kChunk; i < last; ++i) {
            if (i < points_.size()) {
                ask(vec(points_[i]), false);
                continue;
            }
            const Triangle& t = triangles_[i - points_.size()];
            const openvdb::Vec3d a = vec(points_[t[0]]), b = vec(points_[t[1]]), c = vec(points_[t[2]]);
            Parts(a, b, c, partsOf(a, b, c, spacing_), ask).visit();
        }
    });
}

std::vector<FarPlace> SampledSurface::farFrom(const SampledSurface& other, double limit, bool howFar,
                                              const Progress& progress) const {
    if (empty()) return {};
    const std::size_t count = points_.size() + triangles_.size();
    std::vector<std::vector<FarPlace>> found(chunksOf(0, count));
    if (other.empty())
        forSamples(0, count, progress, [&](std::size_t chunk) { return TakesAll{found[chunk]}; });
    else
        forSamples(0, count, progress, [&](std::size_t chunk) {
            return TakesFar{found[chunk], Asker(*other.hierarchy_), limit * limit, howFar};
        });
    std::vector<FarPlace> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

double SampledSurface::farthestOf(std::size_t begin, std::size_t end, const SampledSurface& other,
                                  double atLeast, const Progress& progress) const {
    std::vector<double> squared(chunksOf(begin, end), atLeast * atLeast);
    forSamples(begin, end, progress, [&](std::size_t chunk) {
        return TakesFarthest{squared[chunk], Asker(*other.hierarchy_)};
    });
    double largest = atLeast;
    for (const double s : squared) largest = std::max(largest, std::sqrt(s));
    return largest;
}

// Of the vertices first, which are few: with their largest distance most samples of triangles need not be measured.
double SampledSurface::farthestFrom(const SampledSurface& other, double atLeast,
                                    const Progress& progress) const {
    if (empty()) return atLeast;
    const double ofVertices = farthestOf(0, points_.size(), other, atLeast, progress);
    return farthestOf(points_.size(), points_.size() + triangles_.size(), other, ofVertices, progress);
}

}  // namespace isowave::lod
