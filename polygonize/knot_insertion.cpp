// Block by block: 8^3 control points become 2 fine blocks along each axis that is refined.
#include "polygonize/knot_insertion.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "polygonize/blocks.h"

namespace isowave {
namespace {

using openvdb::Coord;
using Leaf = openvdb::FloatTree::LeafNodeType;
using ShapeLeaf = openvdb::BoolTree::LeafNodeType;

constexpr int kFine = 2 * kBlock;
constexpr int kCoarse = kBlock + 2;  // coarse -1 .. 8 decide fine 0 .. 15

constexpr int fineIndex(int x, int y, int z) { return (x * kFine + y) * kFine + z; }

// What becomes of the lattice.
struct Refinement {
    AxisChoice axes;

    int times(int axis) const { return axes[static_cast<std::size_t>(axis)] ? 2 : 1; }
    Coord fine(const Coord& coarse) const {
        return {coarse.x() * times(0), coarse.y() * times(1), coarse.z() * times(2)};
    }
    // Of the 2^3 fine blocks, where one along each axis lies: from the first one.
    Coord corner(int block) const {
        return {kBlock * (block >> 2), kBlock * (block >> 1 & 1), kBlock * (block & 1)};
    }
    bool has(int block) const {
        const Coord at = corner(block);
        return (axes[0] || at.x() == 0) && (axes[1] || at.y() == 0) && (axes[2] || at.z() == 0);
    }
    void scale(openvdb::math::Transform& lattice) const {
        if (axes[0] && axes[1] && axes[2])
            lattice.preScale(0.5);
        else
            lattice.preScale(openvdb::Vec3d(1.0 / times(0), 1.0 / times(1), 1.0 / times(2)));
    }
};

// One axis: fine 0 .. 15 from coarse -1 .. 8, or 0 .. 7 the same as those; the strides are those of the axis.
void insertKnots(const double* coarse, int coarseStride, double* fine, int fineStride, bool refined) {
    for (int i = 0; i < kBlock; ++i) {
        const double* c = coarse + (i + 1) * coarseStride;
        if (!refined) {
            fine[i * fineStride] = c[0];
            continue;
        }
        fine[2 * i * fineStride] = (c[-coarseStride] + 6 * c[0] + c[coarseStride]) / 8;
        fine[(2 * i + 1) * fineStride] = (c[0] + c[coarseStride]) / 2;
    }
}

using CoarseValues = std::array<double, kCoarse * kCoarse * kCoarse>;
using FineValues = std::array<double, kFine * kFine * kFine>;

void insertKnots(const CoarseValues& coarse, FineValues& fine, const AxisChoice& axes) {
    std::array<double, kCoarse * kCoarse * kFine> z{};
    for (int xy = 0; xy < kCoarse * kCoarse; ++xy)
        insertKnots(&coarse[xy * kCoarse], 1, &z[xy * kFine], 1, axes[2]);
    std::array<double, kCoarse * kFine * kFine> yz{};
    for (int x = 0; x < kCoarse; ++x)
        for (int k = 0; k < kFine; ++k)
            insertKnots(&z[x * kCoarse * kFine + k], kFine, &yz[x * kFine * kFine + k], kFine, axes[1]);
    for (int jk = 0; jk < kFine * kFine; ++jk)
        insertKnots(&yz[jk], kFine * kFine, &fine[jk], kFine * kFine, axes[0]);
}

// The up to 2^3 fine blocks of a coarse one: a leaf each, or nothing and the one inactive value of all its points.
struct FineBlock {
    std::unique_ptr<Leaf> leaf;
    float tile = 0;
};
using FineBlocks = std::array<FineBlock, 8>;

CoarseValues valuesOf(const PaddedBlock& padded) {
    CoarseValues values;
    for (int x = 0, n = 0; x < kCoarse; ++x)
        for (int y = 0; y < kCoarse; ++y)
            for (int z = 0; z < kCoarse; ++z, ++n) values[n] = padded.at(x - 1, y - 1, z - 1);
    return values;
}

// 1 in I. Weights are positive, so a sum > 0 has a term in I.
CoarseValues knownOf(const openvdb::FloatGrid::ConstUnsafeAccessor& accessor, const Coord& origin) {
    CoarseValues known;
    for (int x = 0, n = 0; x < kCoarse; ++x)
        for (int y = 0; y < kCoarse; ++y)
            for (int z = 0; z < kCoarse; ++z, ++n)
                known[n] = accessor.isValueOn(origin.offsetBy(x - 1, y - 1, z - 1));
    return known;
}

// isActive(n, at, value): of the leaf's n-th point, which lies at `at` from the first fine point of the coarse block.
template <class IsActive>
FineBlock fineBlockOf(const FineValues& values, const Coord& origin, const Coord& corner,
                      const IsActive& isActive) {
    FineBlock block;
    block.leaf = std::make_unique<Leaf>(origin + corner, 0.0f, false);
    Leaf& leaf = *block.leaf;
    bool constant = true;
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
        const Coord at = corner + Leaf::offsetToLocalCoord(n);
        const int i = fineIndex(at.x(), at.y(), at.z());
        const float value = static_cast<float>(values[i]);
        const bool active = isActive(i, at, value);
        leaf.setValueOnly(n, value);
        if (active) leaf.setValueOn(n);
        constant = constant && !active && value == leaf.getValue(0);
    }
    block.tile = leaf.getValue(0);
    if (constant) block.leaf.reset();
    return block;
}

FineBlocks fineBlocksOf(const openvdb::FloatGrid::ConstUnsafeAccessor& accessor, const Coord& origin,
                        const Refinement& refinement) {
    PaddedBlock padded;
    padded.gather(accessor, origin);
    FineValues values, known;
    insertKnots(valuesOf(padded), values, refinement.axes);
    insertKnots(knownOf(accessor, origin), known, refinement.axes);
    FineBlocks blocks;
    for (int b = 0; b < 8; ++b)
        if (refinement.has(b))
            blocks[b] =
                fineBlockOf(values, refinement.fine(origin), refinement.corner(b),
                            [&](int i, const Coord& at, float value) {
                                return known[i] > 0 || value != padded.at(at.x() / refinement.times(0),
                                                                          at.y() / refinement.times(1),
                                                                          at.z() / refinement.times(2));
                            });
    return blocks;
}

void put(FineBlock&& block, const Coord& at, openvdb::tree::ValueAccessor<openvdb::FloatTree>& tree) {
    if (block.leaf)
        tree.addLeaf(block.leaf.release());
    else
        tree.addTile(1, at, block.tile, false);
}

// Where the coarse field has one value.
openvdb::FloatTree::Ptr fineTiles(const openvdb::FloatTree& coarse, const Refinement& refinement) {
    auto fine = std::make_shared<openvdb::FloatTree>(coarse.background());
    auto tile = coarse.cbeginValueAll();
    tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        if (*tile == coarse.background()) continue;
        const openvdb::CoordBBox box = tile.getBoundingBox();
        fine->sparseFill({refinement.fine(box.min()), refinement.fine(box.max().offsetBy(1)).offsetBy(-1)},
                         *tile, false);
    }
    return fine;
}

template <class Body>
void forEachBlock(const std::vector<Coord>& origins, const openvdb::FloatTree& tree, const Progress& progress,
                  const Body& body) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, origins.size(), 16), [&](const auto& range) {
        progress.check();
        const openvdb::FloatGrid::ConstUnsafeAccessor accessor(tree);
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i, accessor);
    });
}

openvdb::FloatTree::Ptr fineControlPoints(const openvdb::FloatTree& coarse, const Refinement& refinement,
                                          const Progress& progress) {
    const openvdb::FloatTree::Ptr fine = fineTiles(coarse, refinement);
    const std::vector<Coord> origins = variedBlocks(coarse);
    std::vector<FineBlocks> blocks(origins.size());
    forEachBlock(origins, coarse, progress, [&](std::size_t i, const auto& accessor) {
        blocks[i] = fineBlocksOf(accessor, origins[i], refinement);
    });
    openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(*fine);
    for (std::size_t i = 0; i < blocks.size(); ++i)
        for (int b = 0; b < 8; ++b)
            if (refinement.has(b))
                put(std::move(blocks[i][b]), refinement.fine(origins[i]) + refinement.corner(b), accessor);
    return fine;
}

// ---- only where the surface is

enum class Side : std::uint8_t { outside, inside, both };

// Control points that are no numbers count as both, so that whoever reads the fine field finds them.
Side sideOf(const PaddedBlock& block, float iso) {
    bool inside = false, outside = false;
    for (const float c : block.values) {
        inside |= !(c >= iso);
        outside |= !(c < iso);
    }
    return !inside ? Side::outside : !outside ? Side::inside : Side::both;
}

// Some of a block's 2^3 fine blocks, in the order of FineBlocks.
using Octants = unsigned;

// Those of the block (dx, dy, dz) further that touch this one.
Octants octantsTouching(const Coord& d) {
    constexpr Octants kHigh[3] = {0xf0, 0xcc, 0xaa};
    Octants touching = 0xff;
    for (int axis = 0; axis < 3; ++axis)
        if (d[axis] != 0) touching &= d[axis] < 0 ? kHigh[axis] : ~kHigh[axis];
    return touching;
}

// One voxel a block: its fine blocks on whose cells the surface can be, and all those around them.
std::shared_ptr<const openvdb::Int32Tree> octantsAtSurface(const std::vector<Coord>& origins,
                                                           const std::vector<Side>& sides) {
    auto wanted = std::make_shared<openvdb::Int32Tree>(0);
    openvdb::tree::ValueAccessor<openvdb::Int32Tree> accessor(*wanted);
    for (std::size_t i = 0; i < origins.size(); ++i)
        for (int n = 0; n < 27 && sides[i] == Side::both; ++n) {
            const Coord further(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1), block = (origins[i] >> 3) + further;
            const Octants before = static_cast<Octants>(accessor.getValue(block));
            accessor.setValue(block, static_cast<std::int32_t>(before | octantsTouching(further)));
        }
    return wanted;
}

// A block of one side is one of any value on that side.
FineBlocks blocksAtSurface(const openvdb::FloatGrid::ConstUnsafeAccessor& accessor, const Coord& origin,
                           Octants wanted, float elsewhere, const Refinement& refinement) {
    FineBlocks blocks;
    for (FineBlock& block : blocks) block.tile = elsewhere;
    if (wanted == 0) return blocks;
    PaddedBlock padded;
    padded.gather(accessor, origin);
    FineValues values;
    insertKnots(valuesOf(padded), values, refinement.axes);
    for (int b = 0; b < 8; ++b)
        if (wanted >> b & 1)
            blocks[b] = fineBlockOf(values, refinement.fine(origin), refinement.corner(b),
                                    [](int, const Coord&, float) { return false; });
    return blocks;
}

openvdb::FloatTree::Ptr fineControlPointsAtSurface(const openvdb::FloatTree& coarse, float iso, float K,
                                                   const Progress& progress) {
    const Refinement refinement{{true, true, true}};
    const std::vector<Coord> origins = variedBlocks(coarse);
    std::vector<Side> sides(origins.size());
    forEachBlock(origins, coarse, progress, [&](std::size_t i, const auto& accessor) {
        PaddedBlock padded;
        padded.gather(accessor, origins[i]);
        sides[i] = sideOf(padded, iso);
    });
    const std::shared_ptr<const openvdb::Int32Tree> wanted = octantsAtSurface(origins, sides);
    std::vector<FineBlocks> blocks(origins.size());
    forEachBlock(origins, coarse, progress, [&](std::size_t i, const auto& accessor) {
        const auto octants = static_cast<Octants>(wanted->getValue(origins[i] >> 3));
        blocks[i] =
            blocksAtSurface(accessor, origins[i], octants, sides[i] == Side::inside ? -K : K, refinement);
    });
    const openvdb::FloatTree::Ptr fine = fineTiles(coarse, refinement);
    openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(*fine);
    for (std::size_t i = 0; i < blocks.size(); ++i)
        for (int b = 0; b < 8; ++b)
            put(std::move(blocks[i][b]), refinement.fine(origins[i]) + refinement.corner(b), accessor);
    return fine;
}

// Active where the control points are; true where F < 0.
openvdb::BoolTree::Ptr signsOf(const openvdb::FloatTree& controlPoints, const Progress& progress) {
    auto shape = std::make_shared<openvdb::BoolTree>(controlPoints.background() < 0);
    auto tile = controlPoints.cbeginValueAll();
    tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if ((*tile < 0) != shape->background()) shape->sparseFill(tile.getBoundingBox(), *tile < 0, false);
    const std::vector<Coord> origins = variedBlocks(controlPoints);
    std::vector<std::unique_ptr<ShapeLeaf>> leaves(origins.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, origins.size(), 16), [&](const auto& range) {
        progress.check();
        const openvdb::FloatGrid::ConstUnsafeAccessor accessor(controlPoints);
        PaddedBlock padded;
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            padded.gather(accessor, origins[i]);
            const BlockBits inside = insideBits(padded);
            leaves[i] = std::make_unique<ShapeLeaf>(origins[i], false, false);
            if (const auto* leaf = accessor.probeConstLeaf(origins[i]))
                leaves[i]->setValueMask(leaf->valueMask());
            for (openvdb::Index n = 0; n < ShapeLeaf::SIZE; ++n)
                leaves[i]->setValueOnly(n, inside[n / 64] >> n % 64 & 1);
        }
    });
    openvdb::tree::ValueAccessor<openvdb::BoolTree> accessor(*shape);
    for (auto& leaf : leaves)
        if (openvdb::Index n = 0;
            leaf->isValueMaskOff() && (leaf->buffer() == ShapeLeaf::Buffer(leaf->getValue(n))))
            accessor.addTile(1, leaf->origin(), leaf->getValue(n), false);
        else
            accessor.addLeaf(leaf.release());
    return shape;
}

}  // namespace

Shape::Ptr shapeOf(const openvdb::FloatGrid& controlPoints, const Progress& progress) {
    Shape::Ptr shape = Shape::create(signsOf(controlPoints.tree(), progress));
    shape->setTransform(controlPoints.transform().copy());
    return shape;
}

BSplineField insertKnots(const BSplineField& field, const Progress& progress) {
    return insertKnots(field, AxisChoice{true, true, true}, progress);
}

BSplineField insertKnotsAtSurface(const BSplineField& field, double iso, const Progress& progress) {
    const auto transform = field.transform().copy();
    transform->preScale(0.5);
    BSplineField fine;
    fine.K = field.K;
    fine.controlPoints = openvdb::FloatGrid::create(fineControlPointsAtSurface(
        field.controlPoints->tree(), static_cast<float>(iso), static_cast<float>(field.K), progress));
    fine.controlPoints->setTransform(transform);
    return fine;
}

BSplineField insertKnots(BSplineField field, std::array<int, 3> times, const Progress& progress) {
    while (times[0] > 0 || times[1] > 0 || times[2] > 0) {
        field = insertKnots(field, AxisChoice{times[0] > 0, times[1] > 0, times[2] > 0}, progress);
        for (int& n : times) --n;
    }
    return field;
}

BSplineField insertKnots(const BSplineField& field, const AxisChoice& axes, const Progress& progress) {
    const Refinement refinement{axes};
    openvdb::FloatTree::ConstPtr coarse = field.controlPoints->constTreePtr();
    if (coarse->hasActiveTiles()) {
        auto voxels = std::make_shared<openvdb::FloatTree>(*coarse);
        voxels->voxelizeActiveTiles();
        coarse = voxels;
    }
    const auto transform = field.transform().copy();
    refinement.scale(*transform);

    BSplineField fine;
    fine.K = field.K;
    fine.controlPoints = openvdb::FloatGrid::create(fineControlPoints(*coarse, refinement, progress));
    fine.controlPoints->setTransform(transform);
    fine.shape = shapeOf(*fine.controlPoints, progress);
    fine.controlPoints->setName(field.controlPoints->getName());
    fine.controlPoints->setGridClass(field.controlPoints->getGridClass());
    if (field.shape) fine.shape->setName(field.shape->getName());
    return fine;
}

}  // namespace isowave
