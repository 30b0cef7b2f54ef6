// The lattice points that close a hole, cut a ring, join two parts or open a cavity: a set without which the topology
// would be as before, and of which no point can be spared.
#pragma once

#include <vector>

#include "volume/field.h"

namespace isowave {

inline constexpr int kWidestPlug = 12;  // lattice steps of the mesh from the middle: wider ones are not grown

// fine: a field whose lattice a mesh samples. fill: X = { F < 0 } grows; else X = { F >= 0 } does and the solid is cut. About
// the saddle `at`, which is on the other side: lattice points within `radius` steps of it whose |F| is at most `height`, or that of `at`, go over
// to X in the order of |F| as long as X keeps its topology, then `at` itself, and then all that can go back again,
// the farthest first. Topology is that of the mesh (DecidedSigns), for which faces and cells keep F's sign.
// Empty where `at` does not change the topology, as when the hole is wider than the radius, or is not joined to X
// within it. In the order of the coordinates.
std::vector<openvdb::Coord> leastPlug(const BSplineField& fine, const openvdb::Coord& at, bool fill,
                                      float height, int radius);

}  // namespace isowave
