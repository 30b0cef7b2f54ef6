#include "polygonize/blocks.h"

#include <algorithm>

namespace isowave {
namespace {

using openvdb::Coord;

// One voxel a block: its coordinates are the block's, divided by 8.
class BlockSet {
  public:
    // The block and the 26 around it.
    void addAround(const Coord& origin) {
        const Coord block = origin >> 3;
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dz = -1; dz <= 1; ++dz) accessor_.setValueOn(block.offsetBy(dx, dy, dz));
    }
    std::vector<Coord> origins() const {
        std::vector<Coord> result;
        result.reserve(tree_.activeVoxelCount());
        for (auto voxel = tree_.cbeginValueOn(); voxel; ++voxel) result.push_back(voxel.getCoord() << 3);
        return result;
    }

  private:
    openvdb::MaskTree tree_;
    openvdb::tree::ValueAccessor<openvdb::MaskTree> accessor_{tree_};
};

// Adds the blocks on both sides of a tile's face where the neighbour is a tile of another value. (Where it is
// a leaf, the leaf has added itself.) In a field whose control points outside I keep their sign, there are
// none.
void addSteps(openvdb::tree::ValueAccessor<const openvdb::FloatTree>& accessor,
              const openvdb::CoordBBox& tile, float value, BlockSet& blocks) {
    for (int axis = 0; axis < 3; ++axis)
        for (const bool high : {false, true}) {
            openvdb::CoordBBox face = tile;
            face.min()[axis] = high ? tile.max()[axis] + 1 - kBlock : tile.min()[axis];
            face.max()[axis] = face.min()[axis];
            Coord at;
            for (at[0] = face.min()[0]; at[0] <= face.max()[0]; at[0] += kBlock)
                for (at[1] = face.min()[1]; at[1] <= face.max()[1]; at[1] += kBlock)
                    for (at[2] = face.min()[2]; at[2] <= face.max()[2]; at[2] += kBlock) {
                        Coord beyond = at;
                        beyond[axis] += high ? kBlock : -kBlock;
                        if (accessor.probeConstLeaf(beyond) || accessor.getValue(beyond) == value) continue;
                        blocks.addAround(at);
                        blocks.addAround(beyond);
                    }
        }
}

}  // namespace

BlockBits insideBits(const PaddedBlock& block) {
    constexpr int n = PaddedBlock::kSize;
    const auto mean = [](double a, double b, double c) { return a + 4 * b + c; };
    std::array<double, n * n * kBlock> alongZ;  // [x + 1][y + 1][z]
    for (int xy = 0; xy < n * n; ++xy)
        for (int z = 0; z < kBlock; ++z) {
            const float* c = &block.values[xy * n + z];
            alongZ[xy * kBlock + z] = mean(c[0], c[1], c[2]);
        }
    constexpr int row = kBlock, plane = n * kBlock;
    std::array<double, n * kBlock * kBlock> alongYZ;  // [x + 1][8y + z]
    for (int x = 0; x < n; ++x)
        for (int yz = 0; yz < kBlock * kBlock; ++yz) {
            const double* c = &alongZ[x * plane + yz];
            alongYZ[x * kBlock * kBlock + yz] = mean(c[0], c[row], c[2 * row]);
        }
    BlockBits inside{};
    for (int x = 0; x < kBlock; ++x)
        for (int yz = 0; yz < kBlock * kBlock; ++yz) {
            const double* c = &alongYZ[x * kBlock * kBlock + yz];
            inside[x] |=
                static_cast<std::uint64_t>(mean(c[0], c[kBlock * kBlock], c[2 * kBlock * kBlock]) < 0) << yz;
        }
    return inside;
}

std::vector<Coord> variedBlocks(const openvdb::FloatTree& tree) {
    BlockSet blocks;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) blocks.addAround(leaf->origin());
    openvdb::tree::ValueAccessor<const openvdb::FloatTree> accessor(tree);
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(openvdb::FloatTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile)
        if (*tile != tree.background()) addSteps(accessor, tile.getBoundingBox(), *tile, blocks);
    return blocks.origins();
}

}  // namespace isowave
