// Columns of leaves: the leaves of a tree that share the two coordinates other than a given axis, cut where
// several leaves in a row are missing. The unit of work of a direction: a line along the axis stays within
// its column, and fine columns map to coarse ones one to one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "volume/vdb.h"
#include "wavelets/line_bits.h"

namespace isowave::wavelets {

// The two axes other than `axis`, ascending.
constexpr std::array<int, 2> otherAxes(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

// How far apart neighbours along an axis are in a leaf's linear offsets (x << 6 | y << 3 | z).
inline constexpr std::array<int, 3> kLeafStride = {64, 8, 1};

// Linear offset of a position (0 .. 7) of a leaf's line; lines are numbered as in LeafLines.
constexpr int offsetOf(int axis, int line, int position) {
    const auto other = otherAxes(axis);
    return (line >> kLeafLog2) * kLeafStride[other[0]] + (line & (kLeafDim - 1)) * kLeafStride[other[1]] +
           position * kLeafStride[axis];
}

// One column, or a part of one: leaf k of it (k = position >> 3 along the axis) is leaves[k - first], or null
// where there is none.
struct Column {
    using Leaf = const openvdb::BoolTree::LeafNodeType;

    int u = 0, v = 0;        // origin of the leaves on the two other axes, ascending axis order
    std::int64_t first = 0;  // index of leaves[0]
    std::span<Leaf* const> leaves;

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

// All columns of a shape along an axis. So many leaves are missing between two columns of the same (u, v)
// that no interval and no coarse leaf reaches from one to the other (an interval ends at most one position
// beyond its run, and two are joined across four; the coarse leaf at the end of a column covers at most two
// fine leaves beyond it): work and memory go with the leaves, not with the length of the domain.
//
// In blocks: the columns of one block share the internal nodes above their leaves, in this tree and in that
// of the coarse ones, and no other block's columns do. Within a block they are sorted by (u, v) and position.
// The leaves themselves are not looked at.
class Columns {
  public:
    static constexpr int kGap = 4;

    Columns(const openvdb::BoolTree& shape, int axis);

    std::size_t size() const { return columns_.size(); }
    const Column& operator[](std::size_t i) const { return columns_[i]; }

    // Columns begin .. end - 1.
    struct Range {
        std::size_t begin, end;
    };
    const std::vector<Range>& blocks() const { return blocks_; }

  private:
    std::vector<std::vector<Column::Leaf*>> leaves_;  // by block
    std::vector<Column> columns_;
    std::vector<Range> blocks_;
};

}  // namespace isowave::wavelets
