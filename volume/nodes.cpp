#include "volume/nodes.h"

#include <tbb/parallel_for.h>

#include <memory>

#include "isowave/error.h"
#include "volume/blocks.h"

namespace isowave {
namespace {

using BoolLeaf = openvdb::BoolTree::LeafNodeType;

// What a leaf-sized block of lattice points is.
struct SignBlock {
    std::unique_ptr<BoolLeaf> leaf;  // when a node of the block is stabbed
    bool inside = false;             // otherwise: the sign of all of it
};

// signs: 9^3 lattice points from the block's origin, z fastest.
SignBlock classify(const openvdb::Coord& origin, const std::array<bool, 9 * 9 * 9>& signs) {
    constexpr auto at = [](int x, int y, int z) { return (x * 9 + y) * 9 + z; };
    SignBlock block;
    block.inside = signs[0];
    if (std::all_of(signs.begin(), signs.end(), [&](bool s) { return s == signs[0]; })) return block;
    block.leaf = std::make_unique<BoolLeaf>(origin, false, false);
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z) {
                int inside = 0;
                for (int b = 0; b < 8; ++b)
                    inside += signs[at(x + (b >> 2), y + ((b >> 1) & 1), z + (b & 1))];
                const auto offset = static_cast<openvdb::Index>(x << 6 | y << 3 | z);
                block.leaf->setValueOnly(offset, signs[at(x, y, z)]);
                block.leaf->setActiveState(offset, inside != 0 && inside != 8);
            }
    return block;
}

// makeInside() returns (x, y, z) -> bool for one thread. box: outside of it nothing is inside.
template <class MakeInside>
NodeCollection collect(const openvdb::CoordBBox& box, const MakeInside& makeInside,
                       const Progress& progress) {
    NodeCollection nodes{openvdb::BoolGrid::create(false)};
    if (box.empty()) return nodes;
    // Node i needs corner i + 1, so nodes start one below the box.
    forEachBlock<SignBlock>(
        openvdb::CoordBBox(box.min().offsetBy(-1), box.max()), progress, "collecting nodes",
        [&](const openvdb::Coord& origin, auto& inside) {
            std::array<bool, 9 * 9 * 9> signs;
            for (int x = 0, i = 0; x < 9; ++x)
                for (int y = 0; y < 9; ++y)
                    for (int z = 0; z < 9; ++z, ++i) {
                        const openvdb::Coord c = origin.offsetBy(x, y, z);
                        signs[i] = box.isInside(c) && inside(c);
                    }
            return classify(origin, signs);
        },
        makeInside,
        [&](const openvdb::Coord& origin, SignBlock& block) {
            if (block.leaf)
                nodes.grid->tree().addLeaf(block.leaf.release());
            else if (block.inside)
                nodes.grid->tree().addTile(1, origin, true, false);
        });
    nodes.grid->tree().prune();
    return nodes;
}

}  // namespace

NodeCollection nodesFromSigns(const openvdb::BoolGrid& inside) {
    if (inside.background())
        throw InputError(inside.getName(), "everything far away is inside; a solid must be finite");
    // Every inside region lies in an active or inactive tile or leaf of value true.
    openvdb::CoordBBox box;
    for (auto it = inside.constTree().cbeginValueAll(); it; ++it)
        if (*it) {
            openvdb::CoordBBox here;
            it.getBoundingBox(here);
            box.expand(here);
        }
    NodeCollection nodes = collect(
        box,
        [&inside] {
            return [accessor = openvdb::tree::ValueAccessor<const openvdb::BoolTree>(inside.constTree())](
                       const openvdb::Coord& c) { return accessor.getValue(c); };
        },
        {});
    nodes.grid->setTransform(inside.transform().copy());
    return nodes;
}

NodeCollection nodesFromFunction(const std::function<bool(const openvdb::Coord&)>& inside,
                                 const openvdb::CoordBBox& box) {
    return collect(box, [&inside] { return [&inside](const openvdb::Coord& c) { return inside(c); }; }, {});
}

}  // namespace isowave
