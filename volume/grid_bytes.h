// Grids whose leaves are serialised by several threads; OpenVDB itself writes them one after the other.
#pragma once

#include <functional>
#include <string>

#include "volume/vdb.h"

namespace isowave {

// The same grid (a shallow copy: it shares the tree), to be given to openvdb::io::Archive. What it writes is,
// byte for byte, what the grid itself would: OpenVDB's own code turns each leaf into bytes, in blocks of
// kBlockLeaves that are put together in order, and no more than kBlocksAhead blocks are in memory at a time
// (16 MB at most for float). Float and bool only; any other grid comes back as it is.
openvdb::GridBase::ConstPtr writtenInParallel(const openvdb::GridBase::ConstPtr& grid);

// A grid called `name` that is made when openvdb::io::Archive comes to write it, and goes once it has been written: of many, one
// is in memory at a time. The bytes are those of writtenInParallel(make()). make() is called once for each time it is written.
// REQUIRES: it is given to an Archive that writes statistics (as one does by default), and to nobody else: there is nothing in it.
// Grid: FloatGrid or BoolGrid.
template <class Grid>
openvdb::GridBase::ConstPtr madeWhenWritten(const std::string& name,
                                            std::function<typename Grid::Ptr()> make);

}  // namespace isowave
