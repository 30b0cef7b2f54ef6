// Block by block: 8^3 control points become 2 fine blocks along each axis that is refined.
#include "polygonize/knot_insertion.h"

#include <tbb/parallel_for.h>

#include <array>
#include <memory>
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

FineBlocks fineBlocksOf(const openvdb::FloatGrid::ConstUnsafeAccessor& accessor, const Coord& origin,
                        const Refinement& refinement) {
    PaddedBlock padded;
    padded.gather(accessor, origin);
    CoarseValues values, known;  // known: 1 in I. Weights are positive, so a sum > 0 has a term in I
    for (int x = 0, n = 0; x < kCoarse; ++x)
        for (int y = 0; y < kCoarse; ++y)
            for (int z = 0; z < kCoarse; ++z, ++n) {
                values[n] = padded.at(x - 1, y - 1, z - 1);
                known[n] = accessor.isValueOn(origin.offsetBy(x - 1, y - 1, z - 1));
            }
    FineValues fineValues, fineKnown;
    insertKnots(values, fineValues, refinement.axes);
    insertKnots(known, fineKnown, refinement.axes);

    FineBlocks blocks;
    for (int b = 0; b < 8; ++b) {
        if (!refinement.has(b)) continue;
        const Coord corner = refinement.corner(b);
        auto leaf = std::make_unique<Leaf>(refinement.fine(origin) + corner, 0.0f, false);
        bool constant = true;
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            const Coord at = corner + Leaf::offsetToLocalCoord(n);
            const int i = fineIndex(at.x(), at.y(), at.z());
            const float value = static_cast<float>(fineValues[i]);
            const bool active = fineKnown[i] > 0 ||
                                value != padded.at(at.x() / refinement.times(0), at.y() / refinement.times(1),
                                                   at.z() / refinement.times(2));
            leaf->setValueOnly(n, value);
            if (active) leaf->setValueOn(n);
            constant = constant && !active && value == leaf->getValue(0);
        }
        blocks[b].tile = leaf->getValue(0);
        if (!constant) blocks[b].leaf = std::move(leaf);
    }
    return blocks;
}

openvdb::FloatTree::Ptr fineControlPoints(const openvdb::FloatTree& coarse, const Refinement& refinement,
                                          const Progress& progress) {
    auto fine = std::make_shared<openvdb::FloatTree>(coarse.background());
    // Regions of one value first, then what lies over them.
    auto tile = coarse.cbeginValueAll();
    tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        if (*tile == coarse.background()) continue;
        const openvdb::CoordBBox box = tile.getBoundingBox();
        fine->sparseFill({refinement.fine(box.min()), refinement.fine(box.max().offsetBy(1)).offsetBy(-1)},
                         *tile, false);
    }
    const std::vector<Coord> origins = variedBlocks(coarse);
    std::vector<FineBlocks> blocks(origins.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, origins.size(), 16), [&](const auto& range) {
        progress.check();
        const openvdb::FloatGrid::ConstUnsafeAccessor accessor(coarse);
        for (std::size_t i = range.begin(); i != range.end(); ++i)
            blocks[i] = fineBlocksOf(accessor, origins[i], refinement);
    });
    openvdb::tree::ValueAccessor<openvdb::FloatTree> accessor(*fine);
    for (std::size_t i = 0; i < blocks.size(); ++i)
        for (int b = 0; b < 8; ++b) {
            if (!refinement.has(b)) continue;
            if (blocks[i][b].leaf)
                accessor.addLeaf(blocks[i][b].leaf.release());
            else
                accessor.addTile(1, refinement.fine(origins[i]) + refinement.corner(b), blocks[i][b].tile,
                                 false);
        }
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
