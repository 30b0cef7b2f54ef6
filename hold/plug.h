// The lattice points that close a hole, cut a ring, join two parts or open a cavity: a set without which the topology
// would be as before, and of which no point can be spared.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hold/mesh_lattice.h"

namespace isowave {

struct Plug {
    std::vector<std::int64_t> points;  // of the lattice, ascending
    int touchedOfX = 0, touchedOfY = 0;  // by the point it was grown about: 1, 2 closes a hole, 2, 1 joins
};

// fill: X = { F < 0 } grows; else X = { F >= 0 } does and the solid is cut. About the saddle `at`, which is on the other
// side: within `radius` lattice steps of it, points whose |F| is at most that of `at` go over to X in the order of |F| as long as X keeps
// its topology, then `at` itself, and then all that can go back again, the farthest first. X is joined along axes, so
// that what is left closes its hole however the mesh decides about faces.
// Nothing where `at` does not change the topology, as when the hole is wider than the radius.
std::optional<Plug> leastPlug(const MeshLattice& lattice, std::int64_t at, bool fill, int radius);

}  // namespace isowave
