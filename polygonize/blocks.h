// Dense pieces of a sparse field. A block is the 8x8x8 lattice points that a VDB leaf covers, whether or not
// the tree has a leaf there. Passes over a field work block by block: gather once, then plain arrays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volume/vdb.h"

namespace isowave {

constexpr int kBlock = 8;

// The control points that F needs on a block's cells: from one before the block to two after it on each axis.
struct PaddedBlock {
    static constexpr int kSize = kBlock + 3;
    static constexpr std::array<int, 3> kStride{kSize * kSize, kSize, 1};
    static constexpr int index(int x, int y, int z) { return ((x + 1) * kSize + (y + 1)) * kSize + (z + 1); }

    float at(int x, int y, int z) const { return values[index(x, y, z)]; }  // -1 <= x, y, z <= 9

    std::array<float, kSize * kSize * kSize> values;
};

// Fills `block` with the 11^3 values around the block whose first lattice point is `origin`.
// REQUIRES: origin is a multiple of 8 on each axis.
void gather(const openvdb::FloatGrid::ConstUnsafeAccessor& accessor, const openvdb::Coord& origin,
            PaddedBlock& block);

// One bit a lattice point of a block: word x, bit 8y + z (VDB's order of a leaf's voxels).
using BlockBits = std::array<std::uint64_t, kBlock>;

// Which of the block's lattice points have F < 0.
// Taken from 216 F = (1,4,1) x (1,4,1) x (1,4,1) applied to c: control points have 24 bits and the weights'
// sum 8, so that the sums are exact in double unless neighbours differ by more than 2^21 in size, and F = 0
// is seen as 0.
BlockBits insideBits(const PaddedBlock& block);

// Origins of the blocks that matter, in the order of the tree: every block of which all 27 blocks around
// (itself among them) are tiles of one value is left out. Control points are therefore constant in the padded
// neighbourhood of a block that is not listed.
std::vector<openvdb::Coord> variedBlocks(const openvdb::FloatTree& tree);

}  // namespace isowave
