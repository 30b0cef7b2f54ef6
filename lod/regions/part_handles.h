// The handles of a part of a surface, which may have a border.
#pragma once

#include <cstdint>

#include "isowave/mesh.h"

namespace isowave::lod {

// Of an orientable surface c - (V - E + F + b) / 2, with c its pieces and b the loops of its border: the handles that it would have
// with every loop closed by a disc. So a handle of a closed surface counts in neither of two parts whose common border it runs
// across. Where the border touches itself at a point, that point counts once for each fan of triangles. Indices need not all be used.
// REQUIRES: an edge belongs to at most two triangles.
std::int64_t handlesOf(const TriangleMesh& part);

}  // namespace isowave::lod
