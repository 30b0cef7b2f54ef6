#include "volume/fit/known.h"

#include <openvdb/tools/Morphology.h>
#include <tbb/parallel_for.h>

#include <vector>

#include "volume/padded_leaf.h"

namespace isowave::fitting {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using Mask = openvdb::MaskTree;
using MaskLeaf = Mask::LeafNodeType;

template <class Tree>
using ConstAccessor = openvdb::tree::ValueAccessor<const Tree>;

// The lattice points that are corners of a kept node: voxel i is one when a node of i - {0,1}^3 is kept.
Mask cornersOf(const Mask& nodes) {
    Mask corners;
    openvdb::tree::ValueAccessor<Mask> toTouch(corners);
    for (auto leaf = nodes.cbeginLeaf(); leaf; ++leaf)
        for (int b = 0; b < 8; ++b)
            toTouch.touchLeaf(leaf->origin().offsetBy(8 * (b >> 2), 8 * ((b >> 1) & 1), 8 * (b & 1)));
    openvdb::tree::LeafManager<Mask> leaves(corners);
    leaves.foreach ([&nodes](MaskLeaf& leaf, std::size_t) {
        ConstAccessor<Mask> accessor(nodes);
        PaddedLeaf<bool, 1, 0> kept;
        kept.gather(accessor, leaf.origin(),
                    [](const MaskLeaf& l, openvdb::Index o) { return l.isValueOn(o); });
        LeafWords corner{};
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                const auto row = [&](int dx, int dy) { return &kept.values[kept.index(x - dx, y - dy, 0)]; };
                const bool *a = row(0, 0), *b = row(0, 1), *c = row(1, 0), *d = row(1, 1);
                for (int z = 0; z < 8; ++z) {
                    const bool any = a[z] | b[z] | c[z] | d[z] | a[z - 1] | b[z - 1] | c[z - 1] | d[z - 1];
                    corner[x] |= std::uint64_t(any) << (8 * y + z);
                }
            }
        leaf.setValueMask(maskOf(corner));
    });
    return corners;
}

}  // namespace

Mask knownAround(const Mask& nodes) {
    Mask known = cornersOf(nodes);
    openvdb::tools::dilateActiveValues(known, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    known.voxelizeActiveTiles();
    // Leaves without a single known point would only cost memory, and nodes without leaves make the tree, and a file of it,
    // depend on more than the leaves.
    std::vector<MaskLeaf*> leaves;
    known.stealNodes(leaves);
    Mask result;
    for (MaskLeaf* leaf : leaves)
        if (leaf->isEmpty())
            delete leaf;
        else
            result.addLeaf(leaf);
    return result;
}

openvdb::Coord shiftOf(const openvdb::CoordBBox& known) {
    openvdb::Coord shift(0);
    if (known.empty()) return shift;
    for (int a = 0; a < 3; ++a)
        if (known.min()[a] < -1) shift[a] = -(known.min()[a] & ~7);
    return shift;
}

openvdb::Coord moveOrigin(Mask& known) {
    openvdb::CoordBBox box;
    if (!known.empty()) known.evalActiveVoxelBoundingBox(box);
    const openvdb::Coord shift = shiftOf(box);
    if (shift == openvdb::Coord(0)) return shift;
    std::vector<MaskLeaf*> leaves;
    known.stealNodes(leaves);
    Mask moved;
    for (MaskLeaf* leaf : leaves) {
        leaf->setOrigin(leaf->origin() + shift);
        moved.addLeaf(leaf);
    }
    known.clear();
    known.merge(moved);
    return shift;
}

openvdb::math::Transform::Ptr shiftedTransform(const openvdb::math::Transform& transform,
                                               const openvdb::Coord& shift) {
    auto result = transform.copy();
    result->preTranslate(-shift.asVec3d());
    return result;
}

BSplineField makeField(Shape::Ptr shape, double K, const openvdb::math::Transform& transform) {
    std::vector<const openvdb::BoolTree::LeafNodeType*> signs;
    shape->constTree().getNodes(signs);
    std::vector<FloatLeafPtr> leaves(signs.size());
    tbb::parallel_for(std::size_t(0), leaves.size(),
                      [&](std::size_t i) { leaves[i] = makeLeaf(*signs[i], K); });
    return fieldOfLeaves(std::move(shape), K, transform, std::move(leaves));
}

BSplineField fieldOfLeaves(Shape::Ptr shape, double K, const openvdb::math::Transform& transform,
                           std::vector<FloatLeafPtr> leaves) {
    BSplineField field;
    field.K = K;
    field.shape = std::move(shape);
    field.shape->setTransform(transform.copy());
    const auto k = static_cast<float>(K);
    field.controlPoints = openvdb::FloatGrid::create(k);
    field.controlPoints->setTransform(transform.copy());
    field.controlPoints->setName("field");
    hangLeaves(leaves, field.controlPoints->tree());
    fillInsideTiles(field.controlPoints->tree(), field.shape->constTree(), -1, -k);
    return field;
}

FloatLeafPtr makeLeaf(const openvdb::BoolTree::LeafNodeType& shape, double K) {
    const auto k = static_cast<float>(K);
    auto leaf = std::make_unique<FloatLeaf>(shape.origin(), k, false);
    leaf->setValueMask(shape.getValueMask());
    fillBySign(insideWordsOf(shape), k, leaf->buffer().data());
    return leaf;
}

}  // namespace isowave::fitting
