#include "lod/regions/part_handles.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <vector>

namespace isowave::lod {
namespace {

class Sets {
  public:
    explicit Sets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }

    std::size_t find(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void unite(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }
    std::int64_t countOf(const std::vector<char>& counts) {
        std::int64_t sets = 0;
        for (std::size_t i = 0; i < parent_.size(); ++i) sets += counts[i] && parent_[i] == i;
        return sets;
    }

  private:
    std::vector<std::size_t> parent_;
};

// A side of a triangle: the corners at its ends, as 3 times the triangle and which of its three.
struct Side {
    std::uint32_t low, high;    // points
    std::size_t atLow, atHigh;  // corners
    auto edge() const { return std::tie(low, high); }
};

std::vector<Side> sidesOf(const TriangleMesh& part) {
    std::vector<Side> sides;
    sides.reserve(3 * part.triangles.size());
    for (std::size_t t = 0; t < part.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t from = 3 * t + k, to = 3 * t + (k + 1) % 3;
            const std::uint32_t a = part.triangles[t][k], b = part.triangles[t][(k + 1) % 3];
            sides.push_back(a < b ? Side{a, b, from, to} : Side{b, a, to, from});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge() < b.edge(); });
    return sides;
}

}  // namespace

std::int64_t handlesOf(const TriangleMesh& part) {
    const std::vector<Side> sides = sidesOf(part);
    const std::size_t corners = 3 * part.triangles.size();
    Sets fans(corners),
        pieces(corners);  // corners that are one point; triangles that share edges, by their corners
    for (std::size_t c = 0; c < corners; ++c) pieces.unite(c, c / 3 * 3);
    std::vector<const Side*> border;
    std::int64_t edges = 0;
    for (std::size_t i = 0; i < sides.size(); ++edges) {
        const Side& one = sides[i++];
        if (i == sides.size() || sides[i].edge() != one.edge()) {
            border.push_back(&one);
            continue;
        }
        const Side& other = sides[i++];
        fans.unite(one.atLow, other.atLow);
        fans.unite(one.atHigh, other.atHigh);
        pieces.unite(one.atLow, other.atLow);
    }
    Sets loops(corners);
    std::vector<char> all(corners, 1), onBorder(corners, 0);
    for (const Side* side : border) {
        const std::size_t a = fans.find(side->atLow), b = fans.find(side->atHigh);
        loops.unite(a, b);
        onBorder[a] = onBorder[b] = 1;
    }
    const std::int64_t euler = fans.countOf(all) - edges + static_cast<std::int64_t>(part.triangles.size());
    return pieces.countOf(all) - (euler + loops.countOf(onBorder)) / 2;
}

}  // namespace isowave::lod
