// Columns of leaves: the leaves of a tree that share the two coordinates other than a given axis. The unit of
// work of a direction: a line along the axis stays within its column, and fine columns map to coarse ones one
// to one.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

#include "volume/vdb.h"

namespace isowave::wavelets {

inline constexpr int kLeafLog2 = 3, kLeafDim = 8, kLinesPerLeaf = kLeafDim * kLeafDim;

// The two axes other than `axis`, ascending.
constexpr std::array<int, 2> otherAxes(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

// Where line `line` (0..63) of a leaf starts and how far apart its voxels are, in a leaf's linear offsets
// (x << 6 | y << 3 | z).
struct LineLayout {
    std::array<std::uint16_t, kLinesPerLeaf> start{};
    int stride = 0;

    explicit LineLayout(int axis) {
        constexpr std::array<int, 3> kStride = {64, 8, 1};
        const auto other = otherAxes(axis);
        stride = kStride[axis];
        for (int line = 0; line < kLinesPerLeaf; ++line)
            start[line] =
                static_cast<std::uint16_t>((line >> 3) * kStride[other[0]] + (line & 7) * kStride[other[1]]);
    }
};

// One column: leaf k of it (k = position >> 3 along the axis) is leaves[k - first], or null where there is
// none.
template <class Leaf>
struct LeafColumn {
    int u = 0, v = 0;        // origin of the leaves on the two other axes, ascending axis order
    std::int64_t first = 0;  // index of leaves[0]
    std::vector<Leaf*> leaves;

    Leaf* at(std::int64_t index) const {
        const std::int64_t i = index - first;
        return i < 0 || i >= static_cast<std::int64_t>(leaves.size()) ? nullptr
                                                                      : leaves[static_cast<std::size_t>(i)];
    }
    std::int64_t end() const { return first + static_cast<std::int64_t>(leaves.size()); }
    openvdb::Coord origin(int axis, std::int64_t index) const {
        const auto other = otherAxes(axis);
        openvdb::Coord c;
        c[axis] = static_cast<int>(index * kLeafDim);
        c[other[0]] = u;
        c[other[1]] = v;
        return c;
    }
};

// All columns of a tree along an axis, sorted by (u, v).
template <class Tree>
class LeafColumns {
  public:
    using Leaf = const typename Tree::LeafNodeType;
    using Column = LeafColumn<Leaf>;

    LeafColumns(const Tree& tree, int axis) {
        const auto other = otherAxes(axis);
        std::vector<Leaf*> leaves;
        leaves.reserve(tree.leafCount());
        tree.getNodes(leaves);
        std::sort(leaves.begin(), leaves.end(), [axis, other](Leaf* a, Leaf* b) {
            const auto &p = a->origin(), &q = b->origin();
            return std::tuple(p[other[0]], p[other[1]], p[axis]) <
                   std::tuple(q[other[0]], q[other[1]], q[axis]);
        });
        for (Leaf* leaf : leaves) {
            const auto& o = leaf->origin();
            const std::int64_t index = o[axis] >> kLeafLog2;
            if (columns_.empty() || columns_.back().u != o[other[0]] || columns_.back().v != o[other[1]])
                columns_.push_back({o[other[0]], o[other[1]], index, {}});
            columns_.back().leaves.resize(static_cast<std::size_t>(index - columns_.back().first), nullptr);
            columns_.back().leaves.push_back(leaf);
        }
    }

    const std::vector<Column>& columns() const { return columns_; }

    // The column at (u, v), or null.
    const Column* find(int u, int v) const {
        const auto at =
            std::lower_bound(columns_.begin(), columns_.end(), std::tuple(u, v),
                             [](const Column& c, const auto& key) { return std::tuple(c.u, c.v) < key; });
        return at != columns_.end() && at->u == u && at->v == v ? &*at : nullptr;
    }

  private:
    std::vector<Column> columns_;
};

}  // namespace isowave::wavelets
