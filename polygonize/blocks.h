// Dense pieces of a sparse field. A block is the 8x8x8 lattice points that a VDB leaf covers, whether or not
// the tree has a leaf there. Passes over a field work block by block: gather once, then plain arrays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volume/padded_leaf.h"
#include "volume/vdb.h"

namespace isowave {

constexpr int kBlock = 8;

// The control points that F needs on a block's cells: from one before the block to two after it on each axis.
using PaddedBlock = PaddedLeaf<float, 1, 2>;
constexpr std::array<int, 3> kPaddedStride{PaddedBlock::kSize * PaddedBlock::kSize, PaddedBlock::kSize, 1};

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
