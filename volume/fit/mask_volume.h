// How much of a block of voxels a spline has inside, and where its values must move to have as much inside as a mask.
#pragma once

#include "volume/fit/mask_band.h"

namespace isowave::fitting {

struct BlockShare {
    float missing = 0;  // voxels of the mask less what the spline has inside
    float area = 0;     // voxels that the inside grows by, per voxel that F is lowered by
};
using NearShares = std::array<BlockShare, 27>;  // of a block and those beside it, z fastest

// What a leaf's 8^3 voxels lack, handed out to the blocks whose centres are nearest, by trilinear weights. Voxel i reaches
// from i - 1/2 to i + 1/2 and is cut into 2^3 cells. F of a cell is taken for a plane: f = its mean over the cell, g = the
// cell's edge times its slope, which is that of the means beside it and not taken for less than 1/4; so the share inside is
// 1/2 - f/g, clamped, and grows by 1/g for each voxel that F is lowered by where |f| < g/2. The mean, not the value in the
// middle: walls of one voxel would come out 3 % wrong.
// c: control points, lengths in voxels. distance: negative where the mask has the voxel.
NearShares sharesOf(const PaddedLeaf<float, 2, 2>& c, const LeafValues& distance);

// What to lower v by in the middle block: both sums are interpolated linearly between the blocks' centres, then divided, so
// that the shift is smooth and does not depend on where blocks begin; at most ±1/4 voxel.
// Tried: plain sums of each block. Where a cube's faces lie on borders of blocks, each of the three faces at a corner makes
// up for all that the corner lacks: a cube of 16 voxels gains 3.1 %.
void shiftOf(const NearShares& blocks, LeafValues& shift);

}  // namespace isowave::fitting
