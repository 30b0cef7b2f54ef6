// Values of the tiles of a tree: regions without leaves, where nothing changes sign.
#pragma once

#include <tbb/parallel_for.h>

#include <set>
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

}  // namespace isowave
