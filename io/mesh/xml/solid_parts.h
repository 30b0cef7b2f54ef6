// A closed mesh taken apart into the solids that it bounds.
#pragma once

#include <span>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

// The triangles of each part, in their order: a shell that faces outwards, together with the shells of its cavities, which face
// inwards. A cavity belongs to the smallest shell that it is inside of; one that is inside of none is a part of its own. Parts come
// in the order of their first triangles. Shells are triangles that share points.
std::vector<std::vector<Triangle>> solidParts(std::span<const Point> points,
                                              std::span<const Triangle> triangles);

}  // namespace isowave
