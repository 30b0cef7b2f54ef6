// Leaves hung into trees, many at once.
#pragma once

#include <memory>
#include <vector>

#include "volume/vdb.h"

namespace isowave {

using FloatLeafPtr = std::unique_ptr<openvdb::FloatTree::LeafNodeType>;

// Takes them into a tree that has no leaves yet; some may be null. The order does not matter.
void hangLeaves(std::vector<FloatLeafPtr>& leaves, openvdb::FloatTree& tree);

}  // namespace isowave
