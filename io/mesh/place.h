// Where a mesh's points lie in its file.
#pragma once

#include "isowave/mesh.h"

namespace isowave {

// Points and normals of `mesh` as a file of this format shall have them: turned to RAS where the options ask for it; for GLB Y up,
// in metres.
void placeFor(MeshFormat format, const MeshWriteOptions& options, TriangleMesh& mesh);

}  // namespace isowave
