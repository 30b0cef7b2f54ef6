#include "io/mesh/equal_points.h"

#include <algorithm>
#include <array>
#include <bit>

namespace isowave {
namespace {

std::uint64_t mix(std::uint64_t h) {  // the finaliser of splitmix64 (Steele, Lea and Flood 2014)
    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9u;
    h = (h ^ h >> 27) * 0x94d049bb133111ebu;
    return h ^ h >> 31;
}

// + 0.0 turns -0 into 0 and leaves everything else, NaN's bits too.
std::array<std::uint64_t, 3> bitsOf(const Point& p) {
    return {std::bit_cast<std::uint64_t>(p[0] + 0.0), std::bit_cast<std::uint64_t>(p[1] + 0.0),
            std::bit_cast<std::uint64_t>(p[2] + 0.0)};
}

std::uint64_t hashOf(const Point& p) {
    const auto bits = bitsOf(p);
    return mix(mix(mix(bits[0]) + bits[1]) + bits[2]);
}

// Distinct points, by open addressing with linear probing. A slot holds the upper half of a point's hash, which decides
// nearly all comparisons, and the point's number; at most half of the slots are used.
class PointTable {
  public:
    // A closed mesh's corners have each point six times: room for twice as many points, before it grows.
    explicit PointTable(std::span<const Point> points)
        : points_(points), slots_(std::bit_ceil(std::max<std::size_t>(1024, points.size() / 3)), kFree) {}

    // What put() wants to know of point i. The slot, which may be anywhere, is on its way from memory then.
    std::uint64_t announce(std::uint32_t i) const {
        const std::uint64_t hash = hashOf(points_[i]);
        __builtin_prefetch(&slots_[hash & (slots_.size() - 1)]);
        return hash;
    }

    // The point that was put in before with the coordinates of point i, or i, which is in now. REQUIRES: hash is point i's.
    std::uint32_t put(std::uint32_t i, std::uint64_t hash) {
        if (2 * used_ >= slots_.size()) grow();
        std::size_t at = hash & (slots_.size() - 1);
        for (; slots_[at] != kFree; at = (at + 1) & (slots_.size() - 1)) {
            const auto other = static_cast<std::uint32_t>(slots_[at]);
            if (slots_[at] >> 32 == hash >> 32 && bitsOf(points_[other]) == bitsOf(points_[i])) return other;
        }
        slots_[at] = (hash & kUpper) | i;
        ++used_;
        return i;
    }

  private:
    static constexpr std::uint64_t kUpper = 0xffffffff00000000u, kFree = ~std::uint64_t{0};

    void grow() {
        std::vector<std::uint64_t> old(2 * slots_.size(), kFree);
        old.swap(slots_);
        for (const std::uint64_t slot : old) {
            if (slot == kFree) continue;
            std::size_t at = hashOf(points_[static_cast<std::uint32_t>(slot)]) & (slots_.size() - 1);
            while (slots_[at] != kFree) at = (at + 1) & (slots_.size() - 1);
            slots_[at] = slot;
        }
    }

    std::span<const Point> points_;
    std::vector<std::uint64_t> slots_;
    std::size_t used_ = 0;
};

}  // namespace

DistinctPoints distinctPoints(std::span<const Point> points) {
    PointTable table(points);
    DistinctPoints distinct;
    distinct.which.resize(points.size());
    constexpr std::uint32_t kAhead = 16;  // 8, 16 and 32 are alike, 1 takes a third longer
    const auto count = static_cast<std::uint32_t>(points.size());
    std::array<std::uint64_t, kAhead> hashes{};
    for (std::uint32_t i = 0; i < std::min(count, kAhead); ++i) hashes[i] = table.announce(i);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t first = table.put(i, hashes[i % kAhead]);
        if (count - i > kAhead) hashes[i % kAhead] = table.announce(i + kAhead);
        if (first == i) {
            distinct.which[i] = static_cast<std::uint32_t>(distinct.firsts.size());
            distinct.firsts.push_back(i);
        } else {
            distinct.which[i] = distinct.which[first];
        }
    }
    return distinct;
}

TriangleMesh mergeEqualPoints(const TriangleMesh& mesh) {
    const DistinctPoints distinct = distinctPoints(mesh.points);
    TriangleMesh merged;
    for (const std::uint32_t i : distinct.firsts) {
        merged.points.push_back(mesh.points[i]);
        if (!mesh.normals.empty()) merged.normals.push_back(mesh.normals[i]);
    }
    merged.triangles.reserve(mesh.triangles.size());
    const auto& which = distinct.which;
    for (const auto& [a, b, c] : mesh.triangles) merged.triangles.push_back({which[a], which[b], which[c]});
    return merged;
}

}  // namespace isowave
