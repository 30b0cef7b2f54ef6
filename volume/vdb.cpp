#include "volume/vdb.h"

template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
template class openvdb::tree::Tree<openvdb::BoolTree::RootNodeType>;
template class openvdb::Grid<openvdb::FloatTree>;
template class openvdb::Grid<openvdb::BoolTree>;
