// Levels made from a coarser input instead of from the field: octree pruning and mean pooling.
#pragma once

#include "volume/field.h"

namespace isowave::bench {

// Esteve, Brunet, Vinacua, figure 16: the octree of the solid is cut off some levels above its leaves. A node of the
// cut-off tree is grey where any of its leaves is stabbed; the signs of its corners stay. The fit of that collection
// (fitBinary) is the level. finest: nodes of the lattice; levels >= 1.
NodeCollection prunedCollection(const NodeCollection& finest, int levels);

// The mean of each 2^levels cubed block of signed distances, in voxels of the level; block j holds lattice points
// 2^levels j and on, its value lies at their centre. distance: of half-width >= (halfWidth + 1) 2^levels, so that no
// mean that matters is clamped.
openvdb::FloatGrid::Ptr pooledDistance(const openvdb::FloatGrid& distance, int levels, double halfWidth);

}  // namespace isowave::bench
