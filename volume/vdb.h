// OpenVDB, included in one place. Costs 4 s to compile: include it only in headers that hand out grids.
#pragma once

#include <openvdb/openvdb.h>

namespace isowave {

// openvdb::initialize() is idempotent and thread-safe; call this before reading, writing or registering grids.
inline void initializeVdb() { openvdb::initialize(); }

}  // namespace isowave
