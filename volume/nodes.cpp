// Node-Collections from anything that knows the sign of every lattice point of a box; outside beyond it.
#include <tbb/parallel_for.h>

#include <memory>

#include "base/error.h"
#include "volume/blocks.h"
#include "volume/distance.h"
#include "volume/linear_transform.h"

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

namespace {

// Lattice points of an image as a box; with an open border, the border's voxels continue outwards.
openvdb::CoordBBox boxOf(const Image& image, bool openBorder) {
    openvdb::CoordBBox box(0, 0, 0, int(image.size[0]) - 1, int(image.size[1]) - 1, int(image.size[2]) - 1);
    if (openBorder) box.expand(kOpenBorder);
    return box;
}

float nearestVoxel(const Image& image, const openvdb::Coord& c) {
    const auto clamp = [&](int a) { return std::clamp<std::int64_t>(c[a], 0, image.size[a] - 1); };
    return image
        .values[static_cast<std::size_t>(clamp(0) + image.size[0] * (clamp(1) + image.size[1] * clamp(2)))];
}

template <class Test>
NodeCollection nodesWhere(const Image& image, bool openBorder, const Progress& progress, const Test& test) {
    const auto transform = linearTransform(image.indexToWorld, "image");
    NodeCollection nodes = collect(
        boxOf(image, openBorder),
        [&] { return [&](const openvdb::Coord& c) { return test(nearestVoxel(image, c)); }; }, progress);
    nodes.grid->setTransform(transform);
    return nodes;
}

}  // namespace

NodeCollection nodesFromImage(const Image& image, const ImageSolid& solid, const Progress& progress) {
    const auto iso = static_cast<float>(solid.iso);
    if (solid.invert)
        return nodesWhere(image, solid.openBorder, progress, [iso](float v) { return v < iso; });
    return nodesWhere(image, solid.openBorder, progress, [iso](float v) { return v > iso; });
}

NodeCollection nodesFromLabel(const Image& image, double label, bool openBorder, const Progress& progress) {
    const auto wanted = static_cast<float>(label);
    return nodesWhere(image, openBorder, progress, [wanted](float v) { return v == wanted; });
}

}  // namespace isowave
