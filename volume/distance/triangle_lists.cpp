#include "volume/distance/triangle_lists.h"

#include <algorithm>
#include <cmath>

#include "volume/distance/lanes.h"

namespace isowave {
namespace {

// What rounding to float may take from a distance of blocks below 32 voxels, with room to spare.
constexpr float kSlack = 2e-3f;

// Where triangles share an edge, the one that a point lies above is the nearest, and not, by rounding, its neighbour.
constexpr float kTie = 1e-6f;

// sqrt(3)/2 times the edge between the outermost of n lattice points.
float toCorner(int n) { return std::sqrt(3.0f) / 2 * float(n - 1) + kSlack; }

Place minus(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Place cross(const Place& a, const Place& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Place along(const Place& a, double t, const Place& u) {
    return {a[0] + t * u[0], a[1] + t * u[1], a[2] + t * u[2]};
}

struct Direction {
    float x, y, z;
    Direction() = default;
    explicit Direction(const Place& p)
        : x(static_cast<float>(p[0])), y(static_cast<float>(p[1])), z(static_cast<float>(p[2])) {}
};

// A triangle seen from near a point.
struct Near {
    Direction normal;
    float offset;     // plane: normal.x + offset = 0
    float innermost;  // large; negative where the triangle is flat, so that its edges are all there is
    struct Edge {
        Direction foot;    // of the point on the edge's line
        Direction along;   // unit
        Direction inward;  // unit, in the plane
        float low, high;   // ends, from the foot on
    } edges[3];

    Near(const TriangleSoup::Corners& corners, const Place& point);
};

// Normal, unit vectors along the edges and inwards, lengths.
struct Frame {
    Place p[3], normal, along[3], inward[3];
    double length[3];
    bool flat;  // its edges are all there is

    Frame(const TriangleSoup::Corners& corners, const Place& point)
        : p{minus(corners[0], point), minus(corners[1], point), minus(corners[2], point)} {
        normal = cross(minus(p[1], p[0]), minus(p[2], p[0]));
        double longest = 0;
        for (int k = 0; k < 3; ++k) {
            const Place side = minus(p[(k + 1) % 3], p[k]);
            longest = std::max(longest, dot(side, side));
        }
        const double area = std::sqrt(dot(normal, normal));
        flat = !(area > 1e-9 * longest);
        for (double& x : normal) x *= flat ? 0 : 1 / area;
        for (int k = 0; k < 3; ++k) {
            along[k] = minus(p[(k + 1) % 3], p[k]);
            length[k] = std::sqrt(dot(along[k], along[k]));
            for (double& x : along[k]) x *= length[k] > 0 ? 1 / length[k] : 0;
            inward[k] = cross(normal, along[k]);
        }
    }
};

Near::Near(const TriangleSoup::Corners& corners, const Place& point) {
    const Frame frame(corners, point);
    normal = Direction(frame.normal);
    offset = static_cast<float>(-dot(frame.normal, frame.p[0]));
    innermost = frame.flat ? -1.0f : 1e30f;
    for (int k = 0; k < 3; ++k) {
        const Place &from = frame.p[k], &u = frame.along[k];
        const double at = -dot(from, u);
        edges[k] = {Direction(isowave::along(from, at, u)), Direction(u), Direction(frame.inward[k]),
                    static_cast<float>(-at), static_cast<float>(frame.length[k] - at)};
    }
}

// The same in double, for the triangle that has turned out to be nearest to a point.
class Exact {
  public:
    Exact(const TriangleSoup::Corners& corners, const Place& point);
    double distance(const Place& p) const {
        double squared = 1e300;
        bool inside = !flat_;
        for (const Edge& e : edges_) {
            const Place w = minus(p, e.from);
            const double s = std::clamp(dot(w, e.along), 0.0, e.length);
            const Place rest = isowave::along(w, -s, e.along);
            squared = std::min(squared, dot(rest, rest));
            inside = inside && dot(w, e.inward) >= 0;
        }
        return inside ? std::abs(dot(minus(p, edges_[0].from), normal_)) : std::sqrt(squared);
    }

  private:
    struct Edge {
        Place from, along, inward;  // unit vectors
        double length;
    } edges_[3];
    Place normal_;
    bool flat_;
};

Exact::Exact(const TriangleSoup::Corners& corners, const Place& point) {
    const Frame frame(corners, point);
    for (int k = 0; k < 3; ++k) edges_[k] = {frame.p[k], frame.along[k], frame.inward[k], frame.length[k]};
    normal_ = frame.normal;
    flat_ = frame.flat;
}

// Squared distances of several points. Inside all three edges it is the plane's, elsewhere the least to an edge.
template <class Floats>
ISOWAVE_INLINE Floats squaredDistance(const Near& t, Floats x, Floats y, Floats z) {
    const Floats none = Floats{} + 1e30f;
    const Floats height = t.normal.x * x + t.normal.y * y + t.normal.z * z + t.offset;
    Floats best = none, innermost = Floats{} + t.innermost;
    for (const Near::Edge& e : t.edges) {
        const Floats wx = x - e.foot.x, wy = y - e.foot.y, wz = z - e.foot.z;
        const Floats low = Floats{} + e.low, high = Floats{} + e.high;
        const Floats s = least(most(wx * e.along.x + wy * e.along.y + wz * e.along.z, low), high);
        const Floats rx = wx - s * e.along.x, ry = wy - s * e.along.y, rz = wz - s * e.along.z;
        best = least(best, rx * rx + ry * ry + rz * rz);
        innermost = least(innermost, wx * e.inward.x + wy * e.inward.y + wz * e.inward.z);
    }
    const Floats squared = height * height;
    return innermost >= 0 ? squared : best * (1 + kTie);
}

// Eight points at the corners of a cube, in as many vectors as they take; corner 4 x + 2 y + z.
template <int N>
struct Cube {
    using Floats = typename Lanes<N>::Floats;
    static constexpr int kParts = 8 / N;
    Floats x[kParts], y[kParts], z[kParts];

    ISOWAVE_INLINE Cube(const Direction& middle, float half) {
        for (int n = 0; n < 8; ++n) {
            x[n / N][n % N] = middle.x + (n & 4 ? half : -half);
            y[n / N][n % N] = middle.y + (n & 2 ? half : -half);
            z[n / N][n % N] = middle.z + (n & 1 ? half : -half);
        }
    }
};

// One value for each corner.
struct Eight {
    alignas(32) float values[8];
};

}  // namespace

// Of the block at hand.
struct TriangleLists::Work {
    const TriangleSoup* soup;
    Place middle;
    const TriangleList* triangles;
    std::vector<TriangleSoup::Sphere> spheres;                  // from the block's middle on
    std::vector<Near> prepared;                                 // in the order in which they were wanted
    std::vector<std::unique_ptr<Exact>> exact;                  // of these, where wanted
    std::vector<std::int32_t> place;                            // of the i-th triangle in `prepared`, or -1
    std::vector<Eight> lower, lowerHere;                        // bounds of the distances of eight middles
    std::vector<std::uint8_t> masks;                            // bit n: may be nearest in child n
    std::vector<std::pair<float, std::uint32_t>> nearby, here;  // lower bounds and triangles

    void open(const TriangleSoup& of, const TriangleList& list, const Place& at) {
        soup = &of;
        triangles = &list;
        middle = at;
        const Place& m = of.middle();
        const Direction shift(minus(at, m));
        spheres.resize(list.size());
        for (std::size_t i = 0; i < list.size(); ++i) {
            const auto& s = of.sphere(list[i]);
            spheres[i] = {s.x - shift.x, s.y - shift.y, s.z - shift.z, s.r};
        }
        prepared.clear();
        exact.clear();
        exact.resize(list.size());
        place.assign(list.size(), -1);
        lower.resize(list.size());
        masks.resize(list.size());
    }
    const Near& near(std::uint32_t i) {
        if (place[i] < 0) {
            place[i] = static_cast<std::int32_t>(prepared.size());
            prepared.emplace_back(soup->corners((*triangles)[i]), middle);
        }
        return prepared[static_cast<std::size_t>(place[i])];
    }
    // The distance from a point, from the block's middle on, to the i-th triangle; reach where that is none.
    float distance(std::int32_t i, const Place& from, float reach) {
        if (i < 0) return reach;
        if (!exact[i]) exact[i] = std::make_unique<Exact>(soup->corners((*triangles)[i]), middle);
        return std::min(reach, static_cast<float>(exact[i]->distance(from)));
    }
};

namespace {

using Work = TriangleLists::Work;

// Lower bounds of the distances from the middles of eight blocks, which lie around `middle`, `half` away on each axis, to the
// triangles that at(0) .. at(count - 1) name. r: from a block's middle to its farthest lattice point. Returns for each block
// what no lattice point's distance, or reach, is larger than.
template <int N, class At>
ISOWAVE_INLINE Eight lowerBounds(Work& work, std::size_t count, const At& at, const Direction& middle,
                                 float half, float r, float reach, Eight* lower) {
    using L = Lanes<N>;
    using Floats = typename L::Floats;
    const Cube<N> cube(middle, half);
    constexpr int kParts = Cube<N>::kParts;
    Floats nearest[kParts];
    for (Floats& n : nearest) n = L::all(1e15f);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t triangle = at(i);
        const TriangleSoup::Sphere s = work.spheres[triangle];
        const bool small = s.r <= 0.5f * r;
        const Near* near = small ? nullptr : &work.near(triangle);
        for (int part = 0; part < kParts; ++part) {
            Floats upper;
            if (small) {
                const Floats x = cube.x[part] - s.x, y = cube.y[part] - s.y, z = cube.z[part] - s.z;
                upper = squareRoot(x * x + y * y + z * z);
                L::store(lower[i].values + part * N, upper - s.r);
            } else {
                upper = squareRoot(squaredDistance(*near, cube.x[part], cube.y[part], cube.z[part]));
                L::store(lower[i].values + part * N, upper);
            }
            nearest[part] = least(nearest[part], upper);
        }
    }
    Eight most;
    for (int part = 0; part < kParts; ++part)
        L::store(most.values + part * N, least(nearest[part] + r, L::all(reach)));
    return most;
}

template <class Floats>
ISOWAVE_INLINE float largest(Floats v) {
    float most = v[0];
    for (std::size_t k = 1; k < sizeof v / sizeof v[0]; ++k) most = std::max(most, v[k]);
    return most;
}

template <int N>
ISOWAVE_INLINE void keepNearer(typename Lanes<N>::Floats squared, std::uint32_t triangle,
                               typename Lanes<N>::Floats& best, typename Lanes<N>::Ints& which) {
    const auto nearer = squared < best;
    which = nearer ? Lanes<N>::all(static_cast<std::int32_t>(triangle)) : which;
    best = nearer ? squared : best;
}

// 4^3 lattice points around `middle`, four a row, by the triangles in work.nearby, nearest first.
template <int N>
ISOWAVE_INLINE void fillSparse(Work& work, const Direction& middle, float reach, float* out) {
    using L = Lanes<N>;
    using Floats = typename L::Floats;
    constexpr int kVectors = 64 / N;
    std::sort(work.nearby.begin(), work.nearby.end());
    const float r = toCorner(4);
    Floats best[kVectors];
    typename L::Ints which[kVectors];
    for (Floats& b : best) b = L::all(reach * reach);
    for (auto& w : which) w = L::all(std::int32_t(-1));
    float furthest = reach;
    for (const auto& [lower, triangle] : work.nearby) {
        if (lower - r >= furthest) break;
        const Near& near = work.near(triangle);
        Floats all = Floats{};
        for (int v = 0; v < kVectors; ++v) {
            Floats y, z;
            for (int k = 0; k < N; ++k) {
                y[k] = middle.y - 1.5f + float((v * N + k) >> 2 & 3);
                z[k] = middle.z - 1.5f + float(k & 3);
            }
            const Floats x = L::all(middle.x - 1.5f + float(v * N / 16));
            keepNearer<N>(squaredDistance(near, x, y, z), triangle, best[v], which[v]);
            all = most(all, best[v]);
        }
        furthest = std::sqrt(largest(all));
    }
    for (int n = 0; n < 64; ++n) {
        const int x = n >> 4, y = n >> 2 & 3, z = n & 3;
        const Place at{middle.x - 1.5 + x, middle.y - 1.5 + y, middle.z - 1.5 + z};
        out[x * 64 + y * 8 + z] = work.distance(which[n / N][n % N], at, reach);
    }
}

// Fills work.here with those of work.nearby whose lower bound for block `bit` is at most `limit`, the lowest one first: it tells
// soonest how near the others must be. Without branches, which no processor can foretell here.
ISOWAVE_INLINE void collect(Work& work, unsigned bit, float limit) {
    const std::size_t count = work.nearby.size();
    work.here.resize(count);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const float lower = work.lowerHere[i].values[bit];
        work.here[kept] = {lower, work.nearby[i].second};
        kept += lower <= limit;
    }
    work.here.resize(kept);
    const auto first = std::min_element(work.here.begin(), work.here.end());
    if (first != work.here.end()) std::swap(*first, work.here.front());
}

// The eight lattice points around `middle`. bound: none is farther than that, or than reach.
template <int N>
ISOWAVE_INLINE void fillEight(Work& work, unsigned bit, const Direction& middle, float bound, float reach,
                              float* out) {
    using L = Lanes<N>;
    using Floats = typename L::Floats;
    constexpr int kParts = Cube<N>::kParts;
    const float r = toCorner(2);
    const Cube<N> cube(middle, 0.5f);
    Floats squared[kParts], best[kParts];
    typename L::Ints which[kParts];
    for (int part = 0; part < kParts; ++part) {
        squared[part] = L::all(reach * reach);
        which[part] = L::all(std::int32_t(-1));
        best[part] = L::all(bound);
    }
    float furthest = bound;
    collect(work, bit, bound + r);
    for (const auto& [lower, triangle] : work.here) {
        if (lower - r > furthest) continue;
        const TriangleSoup::Sphere s = work.spheres[triangle];
        bool nearer = false;
        for (int part = 0; part < kParts; ++part) {
            const Floats x = cube.x[part] - s.x, y = cube.y[part] - s.y, z = cube.z[part] - s.z;
            const Floats beyond = best[part] + (s.r + kSlack);
            const auto may = x * x + y * y + z * z < beyond * beyond;
            for (int k = 0; k < N; ++k) nearer |= may[k] != 0;
        }
        if (!nearer) continue;
        const Near& near = work.near(triangle);
        furthest = 0;
        for (int part = 0; part < kParts; ++part) {
            keepNearer<N>(squaredDistance(near, cube.x[part], cube.y[part], cube.z[part]), triangle,
                          squared[part], which[part]);
            best[part] = least(best[part], squareRoot(squared[part]));
            furthest = std::max(furthest, largest(best[part]));
        }
    }
    for (int n = 0; n < 8; ++n) {
        const Place at{middle.x + (n & 4 ? 0.5 : -0.5), middle.y + (n & 2 ? 0.5 : -0.5),
                       middle.z + (n & 1 ? 0.5 : -0.5)};
        out[(n >> 2) * 64 + (n >> 1 & 1) * 8 + (n & 1)] = work.distance(which[n / N][n % N], at, reach);
    }
}

}  // namespace

TriangleSoup::TriangleSoup(std::vector<Corners> corners)
    : corners_(std::move(corners)), spheres_(corners_.size()) {
    Place low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (const Corners& c : corners_)
        for (const Place& p : c)
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], p[a]);
                high[a] = std::max(high[a], p[a]);
            }
    for (std::size_t a = 0; a < 3; ++a) middle_[a] = (low[a] + high[a]) / 2;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Corners& c = corners_[i];
        Place centre;
        for (std::size_t a = 0; a < 3; ++a) centre[a] = (c[0][a] + c[1][a] + c[2][a]) / 3;
        double squared = 0;
        for (const Place& p : c) squared = std::max(squared, dot(minus(p, centre), minus(p, centre)));
        const Direction from(minus(centre, middle_));
        spheres_[i] = {from.x, from.y, from.z, static_cast<float>(std::sqrt(squared))};
    }
}

TriangleLists::TriangleLists(const TriangleSoup& soup, double reach, Vectors widest)
    : soup_(soup), reach_(static_cast<float>(reach)), vectors_(widest), work_(std::make_unique<Work>()) {}
TriangleLists::~TriangleLists() = default;
TriangleLists::TriangleLists(TriangleLists&&) noexcept = default;

// A large block: those whose boxes are within reach of a child's on each axis.
void TriangleLists::splitByBoxes(const TriangleList& triangles, const std::array<int, 3>& origin, int size) {
    work_->masks.resize(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        constexpr unsigned kLow[3] = {0x0f, 0x33, 0x55};  // children in the lower half
        const TriangleSoup::Corners& c = soup_.corners(triangles[i]);
        unsigned mask = 0xff;
        for (std::size_t a = 0; a < 3; ++a) {
            const double low = std::min({c[0][a], c[1][a], c[2][a]}),
                         high = std::max({c[0][a], c[1][a], c[2][a]});
            const double first = origin[a], half = size;
            unsigned near = 0;
            if (high > first - reach_ && low < first + half - 1 + reach_) near |= kLow[a];
            if (high > first + half - reach_ && low < first + 2 * half - 1 + reach_) near |= ~kLow[a];
            mask &= near;
        }
        work_->masks[i] = static_cast<std::uint8_t>(mask);
    }
}

template <int N>
ISOWAVE_INLINE void TriangleLists::maskBy(const TriangleList& triangles, const Place& middle, int size) {
    Work& work = *work_;
    work.open(soup_, triangles, middle);
    const float r = toCorner(size);
    const Eight most = lowerBounds<N>(
        work, triangles.size(), [](std::size_t i) { return static_cast<std::uint32_t>(i); },
        Direction({0, 0, 0}), float(size) / 2, r, reach_, work.lower.data());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        unsigned bits = 0;  // (1), as bound + r
        for (int n = 0; n < 8; ++n) bits |= unsigned(work.lower[i].values[n] <= most.values[n] + r) << n;
        work.masks[i] = static_cast<std::uint8_t>(bits);
    }
}
ISOWAVE_FOUR void TriangleLists::maskByEight(const TriangleList& triangles, const Place& middle, int size) {
    maskBy<8>(triangles, middle, size);
}
void TriangleLists::mask(const TriangleList& triangles, const Place& middle, int size) {
    if (vectors_ == Vectors::two) return maskBy<4>(triangles, middle, size);
    maskByEight(triangles, middle, size);
}

std::array<TriangleList, 8> TriangleLists::split(const TriangleList& triangles,
                                                 const std::array<int, 3>& origin, int size) {
    constexpr int kLarge = 32;  // boxes are as good, and floats would not do
    if (size >= kLarge) {
        splitByBoxes(triangles, origin, size);
    } else {
        Place middle;
        for (std::size_t a = 0; a < 3; ++a) middle[a] = origin[a] + size - 0.5;
        mask(triangles, middle, size);
    }
    std::array<TriangleList, 8> lists;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (unsigned n = 0; n < 8; ++n)
            if (work_->masks[i] >> n & 1) lists[n].push_back(triangles[i]);
    return lists;
}

template <int N>
ISOWAVE_INLINE bool TriangleLists::distancesBy(const TriangleList& triangles, float* distances) {
    // More candidates than that are worth another halving.
    constexpr std::size_t kMany = 24;
    Work& work = *work_;
    for (unsigned n = 0; n < 8; ++n) {
        work.nearby.resize(triangles.size());
        std::size_t kept = 0;
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            work.nearby[kept] = {work.lower[i].values[n], i};
            kept += work.masks[i] >> n & 1;
        }
        work.nearby.resize(kept);
        const Direction middle({n & 4 ? 2.0 : -2.0, n & 2 ? 2.0 : -2.0, n & 1 ? 2.0 : -2.0});
        float* out = distances + (n >> 2) * 256 + (n >> 1 & 1) * 32 + (n & 1) * 4;
        if (work.nearby.size() <= kMany) {
            fillSparse<N>(work, middle, reach_, out);
            continue;
        }
        work.lowerHere.resize(work.nearby.size());
        const Eight bounds = lowerBounds<N>(
            work, work.nearby.size(), [&](std::size_t i) { return work.nearby[i].second; }, middle, 1,
            toCorner(2), reach_, work.lowerHere.data());
        for (unsigned m = 0; m < 8; ++m) {
            const Direction here(
                {middle.x + (m & 4 ? 1 : -1), middle.y + (m & 2 ? 1 : -1), middle.z + (m & 1 ? 1 : -1)});
            fillEight<N>(work, m, here, bounds.values[m], reach_,
                         out + (m >> 2) * 128 + (m >> 1 & 1) * 16 + (m & 1) * 2);
        }
    }
    return std::any_of(distances, distances + 512, [this](float d) { return d < reach_; });
}
ISOWAVE_FOUR bool TriangleLists::distancesByEight(const TriangleList& triangles, float* distances) {
    return distancesBy<8>(triangles, distances);
}

bool TriangleLists::distances(const TriangleList& triangles, const std::array<int, 3>& origin,
                              float* distances) {
    mask(triangles, {origin[0] + 3.5, origin[1] + 3.5, origin[2] + 3.5}, 4);
    if (vectors_ == Vectors::two) return distancesBy<4>(triangles, distances);
    return distancesByEight(triangles, distances);
}

}  // namespace isowave
