// OpenVDB, included in one place. Costs 4 s to compile: include it only in headers that hand out grids.
#pragma once

// Our archives are compiled with hidden symbols, but what OpenVDB keeps in static variables of inline functions (the registry
// of grids) must be one with that of its library.
#pragma GCC visibility push(default)
#include <openvdb/openvdb.h>
#pragma GCC visibility pop

// Compiled once, in vdb.cpp, instead of in every source that works on grids: fit.cpp takes 16 s of CPU instead of 27.
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::BoolTree::RootNodeType>;
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::Grid<openvdb::BoolTree>;

namespace isowave {

// openvdb::initialize() is idempotent and thread-safe; call this before reading, writing or registering
// grids.
inline void initializeVdb() { openvdb::initialize(); }

}  // namespace isowave
