#include "wavelets/columns.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace isowave::wavelets {
namespace {

// The internal nodes above leaves: 16 x 16 x 16 of them.
using InternalNode = openvdb::BoolTree::RootNodeType::ChildNodeType::ChildNodeType;
constexpr int kInternalLog2 = InternalNode::LOG2DIM, kInternalDim = 1 << kInternalLog2;

// For each (u, v) of a node, which leaves along the axis there are.
using ColumnMasks = std::array<std::uint16_t, kInternalDim * kInternalDim>;
static_assert(sizeof(ColumnMasks::value_type) * 8 == kInternalDim);

ColumnMasks masksOf(const InternalNode& node, int axis) {
    const auto other = otherAxes(axis);
    ColumnMasks masks{};
    for (auto child = node.getChildMask().beginOn(); child; ++child) {
        openvdb::Coord at;
        InternalNode::offsetToLocalCoord(child.pos(), at);
        masks[at[other[0]] << kInternalLog2 | at[other[1]]] |= static_cast<std::uint16_t>(1 << at[axis]);
    }
    return masks;
}

// Nodes of the same origin but for the axis, along which they ascend.
struct Block {
    std::span<const InternalNode* const> nodes;
    std::vector<Column> columns;
    std::vector<Column::Leaf*> leaves;  // of one column after the other
};

void findColumns(Block& block, int axis) {
    const auto other = otherAxes(axis);
    std::vector<ColumnMasks> masks;
    for (const InternalNode* node : block.nodes) masks.push_back(masksOf(*node, axis));
    std::vector<std::size_t> starts;
    for (int uv = 0; uv < kInternalDim * kInternalDim; ++uv) {
        std::int64_t next = 0;  // index behind the last leaf of this (u, v)
        bool any = false;
        for (std::size_t i = 0; i < block.nodes.size(); ++i) {
            const InternalNode& node = *block.nodes[i];
            for (unsigned bits = masks[i][uv]; bits != 0; bits &= bits - 1) {
                const int within = std::countr_zero(bits);
                const std::int64_t index = (node.origin()[axis] >> kLeafLog2) + within;
                if (!any || index - next >= Columns::kGap) {
                    starts.push_back(block.leaves.size());
                    block.columns.push_back({node.origin()[other[0]] + (uv >> kInternalLog2) * kLeafDim,
                                             node.origin()[other[1]] + (uv & (kInternalDim - 1)) * kLeafDim,
                                             index,
                                             {}});
                } else {
                    block.leaves.insert(block.leaves.end(), static_cast<std::size_t>(index - next), nullptr);
                }
                const auto slot = InternalNode::coordToOffset(block.columns.back().origin(axis, index));
                block.leaves.push_back(node.getTable()[slot].getChild());
                next = index + 1;
                any = true;
            }
        }
    }
    starts.push_back(block.leaves.size());
    for (std::size_t i = 0; i < block.columns.size(); ++i)
        block.columns[i].leaves = std::span(block.leaves).subspan(starts[i], starts[i + 1] - starts[i]);
}

}  // namespace

Columns::Columns(const openvdb::BoolTree& shape, int axis) {
    const auto other = otherAxes(axis);
    std::vector<const InternalNode*> nodes;
    shape.getNodes(nodes);
    const auto sameBlock = [&](const InternalNode* a, const InternalNode* b) {
        return a->origin()[other[0]] == b->origin()[other[0]] &&
               a->origin()[other[1]] == b->origin()[other[1]];
    };
    std::sort(nodes.begin(), nodes.end(), [&](const InternalNode* a, const InternalNode* b) {
        for (const int i : {other[0], other[1], axis})
            if (a->origin()[i] != b->origin()[i]) return a->origin()[i] < b->origin()[i];
        return false;
    });
    std::vector<Block> blocks;
    for (std::size_t begin = 0, end = 0; begin < nodes.size(); begin = end) {
        while (end < nodes.size() && sameBlock(nodes[begin], nodes[end])) ++end;
        blocks.push_back({std::span(nodes).subspan(begin, end - begin), {}, {}});
    }
    tbb::parallel_for(std::size_t(0), blocks.size(), [&](std::size_t i) { findColumns(blocks[i], axis); });

    std::size_t count = 0;
    for (const Block& block : blocks) count += block.columns.size();
    columns_.reserve(count);
    for (Block& block : blocks) {
        blocks_.push_back({columns_.size(), columns_.size() + block.columns.size()});
        columns_.insert(columns_.end(), block.columns.begin(), block.columns.end());
        leaves_.push_back(std::move(block.leaves));  // where they are: the columns' spans stay valid
    }
}

}  // namespace isowave::wavelets
