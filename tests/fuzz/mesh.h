// Readers of meshes: stl, off, obj, ply, glb.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// parseMesh(), readMeshFile() and, for polygons, parsePolygonMesh(), whose result comes back the same when it is written
// and read again.
std::vector<Target> meshTargets();

}  // namespace isowave::fuzz
