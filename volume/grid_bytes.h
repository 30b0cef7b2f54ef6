// Grids whose leaves are serialised by several threads; OpenVDB itself writes them one after the other.
#pragma once

#include "volume/vdb.h"

namespace isowave {

// The same grid (a shallow copy: it shares the tree), to be given to openvdb::io::Archive. What it writes is,
// byte for byte, what the grid itself would: OpenVDB's own code turns each leaf into bytes, in blocks of
// kBlockLeaves that are put together in order, and no more than kBlocksAhead blocks are in memory at a time
// (16 MB at most for float). Float and bool only; any other grid comes back as it is.
openvdb::GridBase::ConstPtr writtenInParallel(const openvdb::GridBase::ConstPtr& grid);

}  // namespace isowave
