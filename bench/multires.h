// OpenVDB's own levels: MultiResGrid restricts a level set by half, volumeToMesh meshes each.
#pragma once

#include <openvdb/tools/MultiResGrid.h>

#include "isowave/mesh.h"

namespace isowave::bench {

using MultiRes = openvdb::tools::MultiResGrid<openvdb::FloatTree>;

// Triangles counter-clockwise seen from outside.
TriangleMesh multiresMesh(const MultiRes& grids, int level);

}  // namespace isowave::bench
