#include "volume/mesh_winding.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "isowave/error.h"

namespace isowave {
namespace {

// Budget of bits. Corners lie within 2^20 voxels of a lattice point in their middle: |coordinate| <= 2^40
// quanta, differences <= 2^41, an edge function or an area <= 2 * 2^82 = 2^83. The crossing's numerator is a
// convex combination of the corners' x times the area, <= 2^123, and the denominator in voxels <= 2^103: all
// below 2^127.
constexpr int kQuantumBits = 20;
constexpr int kExtentBits = 20;
constexpr std::int64_t kVoxel = std::int64_t(1) << kQuantumBits;
static_assert(2 * (kExtentBits + kQuantumBits + 1) + 1 + kExtentBits + kQuantumBits < 127, "update comment");

__extension__ using Wide = __int128;

struct Quantum {
    std::int64_t x, y, z;
};

std::int64_t ceilDivide(Wide numerator, Wide denominator) {  // denominator > 0
    const Wide quotient = numerator / denominator;
    return static_cast<std::int64_t>(quotient + (numerator % denominator > 0));
}

std::int64_t ceilVoxel(std::int64_t q) { return (q + kVoxel - 1) >> kQuantumBits; }
std::int64_t floorVoxel(std::int64_t q) { return q >> kQuantumBits; }

// Twice the signed area of (a, b, p) in the yz-plane.
Wide cross(const Quantum& a, const Quantum& b, std::int64_t y, std::int64_t z) {
    return Wide(b.y - a.y) * (z - a.z) - Wide(b.z - a.z) * (y - a.y);
}

// Whether p = (y + e, z + e^2) lies left of a -> b. Its cross() grows by e^2 (b.y - a.y) - e (b.z - a.z),
// which decides where it is 0. REQUIRES: a and b differ in the yz-plane.
bool isLeft(const Quantum& a, const Quantum& b, Wide value) {
    if (value != 0) return value > 0;
    return a.z != b.z ? b.z < a.z : b.y > a.y;
}

}  // namespace

// invariant: visits the same crossings in both passes.
struct LatticeLines::Rasteriser {
    std::vector<Quantum> corners;
    const std::vector<Triangle>& triangles;
    openvdb::Coord middle;  // what corners are relative to

    // Calls visit(y, z, crossing) for the lines that triangle t meets; crossing() gives x, relative to the
    // middle: the first lattice point at or beyond it.
    template <class Visit>
    void forEachLine(const Triangle& t, const Visit& visit) const {
        const Quantum &a = corners[t[0]], &b = corners[t[1]], &c = corners[t[2]];
        const Wide area = cross(a, b, c.y, c.z);
        if (area == 0) return;  // seen edge-on: no shifted line meets it
        const bool left = area > 0;
        const auto [yMin, yMax] = std::minmax({a.y, b.y, c.y});
        const auto [zMin, zMax] = std::minmax({a.z, b.z, c.z});
        for (std::int64_t k = ceilVoxel(zMin); k <= floorVoxel(zMax); ++k) {
            for (std::int64_t j = ceilVoxel(yMin); j <= floorVoxel(yMax); ++j) {
                const std::int64_t y = j * kVoxel, z = k * kVoxel;
                const Wide toC = cross(a, b, y, z), toA = cross(b, c, y, z), toB = cross(c, a, y, z);
                if (isLeft(a, b, toC) != left || isLeft(b, c, toA) != left || isLeft(c, a, toB) != left)
                    continue;
                visit(static_cast<std::int32_t>(j) + middle.y(), static_cast<std::int32_t>(k) + middle.z(),
                      [&] {
                          // Barycentric: toA + toB + toC = area, each of area's sign or 0.
                          const Wide numerator = toA * a.x + toB * b.x + toC * c.x;
                          return ceilDivide(left ? numerator : -numerator, (left ? area : -area) * kVoxel);
                      });
            }
        }
    }

    template <class Visit>
    void forEachCrossing(const Progress& progress, const Visit& visit) const {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), 1024), [&](const auto& range) {
            progress.check();
            for (std::size_t t = range.begin(); t != range.end(); ++t) {
                const Triangle& triangle = triangles[t];
                const bool leaving = cross(corners[triangle[0]], corners[triangle[1]], corners[triangle[2]].y,
                                           corners[triangle[2]].z) > 0;  // the normal's x
                forEachLine(triangle, [&](std::int32_t y, std::int32_t z, const auto& crossing) {
                    visit(y, z, leaving, crossing);
                });
            }
        });
    }
};

namespace {

struct LineReport {
    bool closed;                   // it ends outside
    std::int32_t buried, skipped;  // crossings between two inside points, and between two outside
    bool overlaps;                 // one of its points has a winding number beyond 1
};

// Sorts a line's crossings and turns them into toggles, in place. A crossing is 2 x + (leaving ? 1 : 0).
LineReport toToggles(std::int32_t* first, std::int32_t* last, std::int32_t middle, bool evenOdd) {
    std::sort(first, last);
    std::int32_t* out = first;
    int winding = 0;
    bool inside = false, overlaps = false;
    std::int32_t buried = 0, skipped = 0;
    for (const std::int32_t* in = first; in != last;) {
        const std::int32_t x = *in >> 1;
        for (; in != last && (*in >> 1) == x; ++in) winding += evenOdd || !(*in & 1) ? 1 : -1;
        const bool now = evenOdd ? winding % 2 != 0 : winding != 0;
        if (now != inside) *out++ = x + middle;  // invariant: out < in
        buried += now && inside;
        skipped += !now && !inside;
        overlaps = overlaps || (!evenOdd && std::abs(winding) > 1);
        inside = now;
    }
    std::fill(out, last, std::numeric_limits<std::int32_t>::max());
    return {!inside, buried, skipped, overlaps};
}

}  // namespace

LatticeLines::LatticeLines(const std::vector<openvdb::Vec3d>& points, const std::vector<Triangle>& triangles,
                           bool evenOdd, const Progress& progress) {
    openvdb::BBoxd bounds;
    for (const Triangle& triangle : triangles) {
        for (const auto corner : triangle) bounds.expand(points[corner]);
    }
    if (triangles.empty()) return;
    const openvdb::Vec3d centre = bounds.getCenter();
    const double reach = bounds.extents()[bounds.maxExtent()] / 2 + 1;
    if (!(reach <= std::ldexp(1.0, kExtentBits)) || !(centre.length() < std::ldexp(1.0, 30))) {
        throw InputError("mesh",
                         fmt::format("spans {:g} voxels around index {:g}; at most 2^20 around 2^30 are "
                                     "possible: take larger voxels",
                                     2 * reach, centre.length()));
    }

    Rasteriser raster{{}, triangles, openvdb::Coord::round(centre)};
    raster.corners.resize(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const openvdb::Vec3d q = (points[i] - raster.middle.asVec3d()) * double(kVoxel);
            raster.corners[i] = {std::llround(q.x()), std::llround(q.y()), std::llround(q.z())};
        }
    });

    // The lines that rounded corners span, and a lattice point more on either side.
    box_ = openvdb::CoordBBox(openvdb::Coord::floor(bounds.min()).offsetBy(-1),
                              openvdb::Coord::ceil(bounds.max()).offsetBy(1));
    const std::size_t lines = std::size_t(box_.dim().y()) * std::size_t(box_.dim().z());

    // count -> offsets -> fill -> toggles. Counts sit one to the right, and end as starts.
    start_.assign(lines + 2, 0);
    raster.forEachCrossing(progress, [&](std::int32_t y, std::int32_t z, bool, const auto&) {
        std::atomic_ref(start_[lineOf(y, z) + 2]).fetch_add(1, std::memory_order_relaxed);
    });
    std::uint64_t total = 0;
    for (std::uint32_t& count : start_) {
        total += count;
        count = static_cast<std::uint32_t>(total);
    }
    if (total > std::numeric_limits<std::uint32_t>::max()) {
        throw InputError("mesh", fmt::format("crosses the lattice {} times; take larger voxels", total));
    }
    toggles_.resize(total);
    raster.forEachCrossing(progress, [&](std::int32_t y, std::int32_t z, bool leaving, const auto& crossing) {
        const auto slot = std::atomic_ref(start_[lineOf(y, z) + 1]).fetch_add(1, std::memory_order_relaxed);
        toggles_[slot] = static_cast<std::int32_t>(crossing() * 2 + (leaving ? 1 : 0));
    });
    start_.pop_back();

    std::atomic<std::size_t> open = 0;
    std::atomic<std::int64_t> buried = 0, skipped = 0;
    std::atomic<bool> overlap = false;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lines, 1024), [&](const auto& range) {
        progress.check();
        for (std::size_t l = range.begin(); l != range.end(); ++l) {
            const LineReport line = toToggles(toggles_.data() + start_[l], toggles_.data() + start_[l + 1],
                                              raster.middle.x(), evenOdd);
            open += !line.closed;
            if (line.buried > 0) buried += line.buried;
            if (line.skipped > 0) skipped += line.skipped;
            if (line.overlaps) overlap = true;
        }
    });
    if (open > 0) {
        throw InputError("mesh",
                         fmt::format("is not closed: {} of {} lattice lines enter it and never leave; "
                                     "repair it first",
                                     open.load(), lines));
    }
    buried_ = buried;
    skipped_ = skipped;
    hasOverlap_ = overlap;
}

std::pair<const std::int32_t*, const std::int32_t*> LatticeLines::togglesBeyond(
    const openvdb::Coord& point) const {
    const std::size_t line = lineOf(point.y(), point.z());
    const std::int32_t* first = toggles_.data() + start_[line];
    const std::int32_t* last = toggles_.data() + start_[line + 1];
    return {std::upper_bound(first, last, point.x()), last};
}

bool LatticeLines::inside(const openvdb::Coord& point) const {
    if (!box_.isInside(point)) return false;
    const std::size_t line = lineOf(point.y(), point.z());
    return (togglesBeyond(point).first - (toggles_.data() + start_[line])) % 2 != 0;
}

std::int64_t LatticeLines::insideCount() const {
    constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();
    std::int64_t count = 0;
    for (std::size_t line = 0; line + 1 < start_.size(); ++line)
        for (std::uint32_t t = start_[line]; t + 1 < start_[line + 1] && toggles_[t] != kNone; t += 2)
            count += toggles_[t + 1] - toggles_[t];
    return count;
}

unsigned LatticeLines::inside8(const openvdb::Coord& low) const {
    if (low.y() < box_.min().y() || low.y() > box_.max().y() || low.z() < box_.min().z() ||
        low.z() > box_.max().z()) {
        return 0;
    }
    const std::size_t line = lineOf(low.y(), low.z());
    auto [toggle, last] = togglesBeyond(low);
    bool now = (toggle - (toggles_.data() + start_[line])) % 2 != 0;
    unsigned bits = 0;
    for (int i = 0; i < 8; ++i) {
        for (; toggle != last && *toggle <= low.x() + i; ++toggle) now = !now;
        bits |= unsigned(now) << i;
    }
    return bits;
}

}  // namespace isowave
