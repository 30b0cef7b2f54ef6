// signPart() of field_part.h: the slots of a part's tree.
#pragma once

#include <set>
#include <vector>

#include "volume/tiles.h"

namespace isowave {

// The internal nodes of one kind beside those of a shape: origins in a tree whose coordinate along `halved` is half as large.
template <class ShapeNode>
std::set<openvdb::Coord> regionsBeside(const openvdb::BoolTree& shape, int halved) {
    std::vector<const ShapeNode*> nodes;
    shape.getNodes(nodes);
    std::set<openvdb::Coord> regions;
    for (const ShapeNode* node : nodes) {
        openvdb::Coord origin = node->origin();
        if (halved >= 0) origin[halved] >>= 1;
        regions.insert(origin & ~(static_cast<int>(ShapeNode::DIM) - 1));
    }
    return regions;
}

template <class Tree>
void signPart(Tree& tree, const openvdb::BoolTree& shape, int halved, typename Tree::ValueType inside) {
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    using ShapeUpper = openvdb::BoolTree::RootNodeType::ChildNodeType;
    const auto background = tree.background();
    // A tile of the background, then one of its slots: a node of background.
    for (const auto& origin : regionsBeside<ShapeUpper>(shape, halved))
        if (!tree.template probeConstNode<Upper>(origin)) {
            tree.addTile(Upper::LEVEL + 1, origin, background, false);
            tree.addTile(Upper::LEVEL, origin, background, false);
        }
    for (const auto& origin : regionsBeside<typename ShapeUpper::ChildNodeType>(shape, halved))
        if (!tree.template probeConstNode<Lower>(origin)) {
            tree.addTile(Lower::LEVEL + 1, origin, background, false);
            tree.addTile(Lower::LEVEL, origin, background, false);
        }
    fillInsideTiles(tree, shape, halved, inside);
}

}  // namespace isowave
