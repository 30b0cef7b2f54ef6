// Values of the tiles of a tree: regions without leaves, where nothing changes sign.
#pragma once

#include <tbb/parallel_for.h>

#include <array>
#include <set>
#include <type_traits>
#include <vector>

#include "volume/vdb.h"

namespace isowave {

// Sets every tile below the root to lookup(its first lattice point). makeLookup() returns a function object
// Coord -> value that one thread uses (it may hold an accessor).
// REQUIRES: each slot without leaves lies in a region of one value.
template <class Tree, class MakeLookup>
void fillTiles(Tree& tree, const MakeLookup& makeLookup) {
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using Lower = typename Upper::ChildNodeType;
    const auto fill = [&makeLookup](auto& nodes) {
        tbb::parallel_for(std::size_t(0), nodes.size(), [&](std::size_t i) {
            auto lookup = makeLookup();
            // "All" are all slots without a child; "Off" would run over the children too.
            for (auto tile = nodes[i]->beginValueAll(); tile; ++tile) tile.setValue(lookup(tile.getCoord()));
        });
    };
    std::vector<Lower*> lower;
    std::vector<Upper*> upper;
    tree.getNodes(lower);
    tree.getNodes(upper);
    fill(lower);
    fill(upper);
}

// The root's own tiles, regions of 4096^3 lattice points: wherever `from` has a child or a tile (its region's
// origin taken to this tree by toThis) and `tree` has no child, a tile of lookup(origin) unless that is the
// background.
template <class Tree, class From, class ToThis, class MakeLookup>
void fillRootTiles(Tree& tree, const From& from, const ToThis& toThis, const MakeLookup& makeLookup) {
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    constexpr int kRegion = Upper::DIM;
    std::set<openvdb::Coord> regions;
    const auto add = [&](const openvdb::Coord& c) { regions.insert(toThis(c) & ~(kRegion - 1)); };
    for (auto it = from.root().cbeginChildOn(); it; ++it) add(it.getCoord());
    for (auto it = from.root().cbeginValueAll(); it; ++it) add(it.getCoord());
    auto lookup = makeLookup();
    for (const auto& region : regions) {
        if (tree.template probeConstNode<Upper>(region)) continue;
        const auto value = lookup(region);
        if (value != tree.background()) tree.root().addTile(region, value, false);
    }
}

// Internal nodes of a shape's tree beside one of another tree: one, or two along an axis that the other tree
// has halved.
template <class ShapeNode>
class ShapeBeside {
  public:
    // origin: of the other tree's node. halved: 0, 1, 2; -1: none.
    ShapeBeside(const openvdb::BoolTree& shape, openvdb::Coord origin, int halved) : halved_(halved) {
        if (halved >= 0) origin[halved] *= 2;
        for (int part = 0; part < (halved < 0 ? 1 : 2); ++part) {
            nodes_[part] = shape.probeConstNode<ShapeNode>(origin);
            tiles_[part] = !nodes_[part] && shape.getValue(origin);
            if (halved >= 0) origin[halved] += kDim;
        }
    }
    bool isOutside() const { return !nodes_[0] && !nodes_[1] && !tiles_[0] && !tiles_[1]; }
    // c: first lattice point of a slot of the other tree's node.
    bool inside(openvdb::Coord c) const {
        int part = 0;
        if (halved_ >= 0) {
            c[halved_] *= 2;
            part = (c[halved_] & kDim) != 0;
        }
        const ShapeNode* node = nodes_[part];
        if (!node) return tiles_[part];
        const auto n = ShapeNode::coordToOffset(c);
        const auto& entry = node->getTable()[n];
        if (!node->getChildMask().isOn(n)) return entry.getValue();
        // Not getFirstValue(): a leaf of bools returns whether its first value is active (OpenVDB 10.0).
        return entry.getChild()->getValue(c);
    }

  private:
    static constexpr int kDim = ShapeNode::DIM;

    int halved_;
    std::array<const ShapeNode*, 2> nodes_{};
    std::array<bool, 2> tiles_{};
};

// Tiles of `tree`, the root's own among them, that a shape has inside, set to `inside`; the others stay what
// they are, the background. A lattice point of `tree` is the shape's whose coordinate along `halved` (0, 1,
// 2; -1: none) is twice as large. Internal node by internal node: one table access a tile, where fillTiles()
// descends from the root.
// REQUIRES: as fillTiles().
template <class Tree>
void fillInsideTiles(Tree& tree, const openvdb::BoolTree& shape, int halved,
                     typename Tree::ValueType inside) {
    const auto fill = [&](const auto& nodes, auto shapeNode) {
        tbb::parallel_for(std::size_t(0), nodes.size(), [&](std::size_t i) {
            auto& node = *nodes[i];
            const ShapeBeside<std::remove_pointer_t<decltype(shapeNode)>> beside(shape, node.origin(),
                                                                                 halved);
            if (beside.isOutside()) return;
            for (openvdb::Index n = 0; n < node.NUM_VALUES; ++n)
                if (!node.getChildMask().isOn(n) && beside.inside(node.offsetToGlobalCoord(n)))
                    node.addTile(n, inside, node.getValueMask().isOn(n));
        });
    };
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    using ShapeUpper = openvdb::BoolTree::RootNodeType::ChildNodeType;
    std::vector<typename Upper::ChildNodeType*> lower;
    std::vector<Upper*> upper;
    tree.getNodes(lower);
    tree.getNodes(upper);
    fill(lower, static_cast<typename ShapeUpper::ChildNodeType*>(nullptr));
    fill(upper, static_cast<ShapeUpper*>(nullptr));

    const auto toTree = [halved](openvdb::Coord c) {
        if (halved >= 0) c[halved] >>= 1;
        return c;
    };
    fillRootTiles(tree, shape, toTree, [&] {
        return [&](openvdb::Coord c) {
            if (halved >= 0) c[halved] *= 2;
            return shape.getValue(c) ? inside : tree.background();
        };
    });
}

}  // namespace isowave
