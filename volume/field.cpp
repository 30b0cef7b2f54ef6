#include "volume/field.h"

#include <array>
#include <bit>

#include "volume/cubic_weights.h"
#include "volume/leaf_words.h"

namespace isowave {
namespace {

struct Weights {
    openvdb::Coord first;                        // lowest of the 4 control points on each axis
    std::array<std::array<double, 4>, 3> value;  // B(x - i) on each axis
    std::array<std::array<double, 4>, 3> slope;  // its derivative
};

Weights weightsAt(const openvdb::Vec3d& x) {
    Weights w;
    for (int a = 0; a < 3; ++a) {
        const double cell = std::floor(x[a]), t = x[a] - cell, u = 1 - t;
        w.first[a] = static_cast<int>(cell) - 1;
        w.value[a] = cubicWeights(t);
        w.slope[a] = {-u * u / 2, (3 * t * t - 4 * t) / 2, (-3 * t * t + 2 * t + 1) / 2, t * t / 2};
    }
    return w;
}

}  // namespace

double evaluate(const BSplineField& field, const openvdb::Vec3d& x) {
    const Weights w = weightsAt(x);
    const auto accessor = field.controlPoints->getConstUnsafeAccessor();
    double sum = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k)
                sum += w.value[0][i] * w.value[1][j] * w.value[2][k] *
                       accessor.getValue(w.first.offsetBy(i, j, k));
    return sum;
}

openvdb::Vec3d evaluateGradient(const BSplineField& field, const openvdb::Vec3d& x) {
    const Weights w = weightsAt(x);
    const auto accessor = field.controlPoints->getConstUnsafeAccessor();
    openvdb::Vec3d sum(0);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k) {
                const double c = accessor.getValue(w.first.offsetBy(i, j, k));
                sum += c * openvdb::Vec3d(w.slope[0][i] * w.value[1][j] * w.value[2][k],
                                          w.value[0][i] * w.slope[1][j] * w.value[2][k],
                                          w.value[0][i] * w.value[1][j] * w.slope[2][k]);
            }
    return sum;
}

openvdb::MaskTree definedNodes(const BSplineField& field) {
    // A node needs the 4^3 block i-1 .. i+2. Eroding the mask with that block, one axis at a time.
    openvdb::MaskTree mask(field.controlPoints->tree(), false, openvdb::TopologyCopy());
    for (int a = 0; a < 3; ++a) {
        const openvdb::MaskTree before(mask);
        const auto accessor = openvdb::tree::ValueAccessor<const openvdb::MaskTree>(before);
        for (auto leaf = mask.beginLeaf(); leaf; ++leaf)
            for (auto voxel = leaf->beginValueOn(); voxel; ++voxel) {
                bool whole = true;
                for (const int s : {-1, 1, 2}) {
                    openvdb::Coord at = voxel.getCoord();
                    at[a] += s;
                    whole = whole && accessor.isValueOn(at);
                }
                if (!whole) leaf->setValueOff(voxel.pos());
            }
    }
    return mask;
}

std::int64_t definedNodeCount(const BSplineField& field) {
    return static_cast<std::int64_t>(definedNodes(field).activeVoxelCount());
}

std::int64_t pointsInside(const Shape& shape) {
    std::int64_t count = 0;
    for (auto leaf = shape.constTree().cbeginLeaf(); leaf; ++leaf)
        for (const std::uint64_t word : insideWordsOf(*leaf)) count += std::popcount(word);
    auto tile = shape.cbeginValueAll();
    tile.setMaxDepth(openvdb::BoolTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (*tile) count += static_cast<std::int64_t>(tile.getVoxelCount());
    return count;
}

}  // namespace isowave
