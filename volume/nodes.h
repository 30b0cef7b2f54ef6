// Node-Collections, the input of fitBinary(), from anything that knows the sign of every lattice point.
#pragma once

#include <functional>

#include "volume/field.h"

namespace isowave {

// The nodes whose corner signs differ. inside: value = inside everywhere (its active states are ignored).
NodeCollection nodesFromSigns(const openvdb::BoolGrid& inside);
NodeCollection nodesFromFunction(const std::function<bool(const openvdb::Coord&)>& inside,
                                 const openvdb::CoordBBox& box);

}  // namespace isowave
