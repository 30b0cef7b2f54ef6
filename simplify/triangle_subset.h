// Fewer triangles of a large mesh, evenly chosen, to measure distances from.
#pragma once

#include <cstddef>

#include "isowave/mesh.h"

namespace isowave {

// Every k-th triangle, with the smallest k that leaves at most `atMost` of them; each with points of its own
// when k > 1.
// REQUIRES: atMost >= 1.
TriangleMesh evenSubset(const TriangleMesh& mesh, std::size_t atMost);

}  // namespace isowave
