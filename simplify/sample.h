// Fewer triangles of a large mesh, to measure distances from.
#pragma once

#include <cstddef>

#include "isowave/mesh.h"

namespace isowave {

// Every k-th triangle, with the smallest k that leaves `atMost` of them; each with points of its own when k > 1.
// REQUIRES: atMost >= 1.
TriangleMesh everyFew(const TriangleMesh& mesh, std::size_t atMost);

}  // namespace isowave
