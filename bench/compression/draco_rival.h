// Draco: a mesh whose coordinates are rounded, coded edge by edge.
#pragma once

#include <string>
#include <string_view>

#include "isowave/mesh.h"

namespace isowave::bench {

bool hasDraco();
// bits: of each coordinate, of the longest edge of the bounding box. Without normals, at Draco's slowest and smallest.
// Throws std::runtime_error, also where Draco is not installed.
std::string dracoBytes(const TriangleMesh& mesh, int bits);
TriangleMesh meshOfDraco(std::string_view bytes);

}  // namespace isowave::bench
