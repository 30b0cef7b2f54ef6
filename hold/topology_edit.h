// A cut or a fill that leaves one part, handle or cavity less.
#pragma once

#include "volume/vdb.h"

namespace isowave {

struct TopologyEdit {
    enum class Kind { cut, fill } kind = Kind::cut;
    enum class What { part, handle, cavity } what = What::handle;  // of which there is one less
    openvdb::Vec3d at{0.0};  // world: in the middle of the cut or the plug
    double volume = 0;       // world units^3 that the mesh gains (fills) or loses (cuts, negative)
};

}  // namespace isowave
