// Cutting a mesh off at the faces of a box: what an open image border needs.
#pragma once

#include "isowave/mesh.h"
#include "volume/vdb.h"

namespace isowave {

// The part of `mesh` inside the box [low, high] of index space (worldToIndex: row vectors, index = (x,y,z,1)
// * M). Triangles that a face of the box crosses are cut exactly there; vertices on a cut edge are made once,
// so the result is as manifold as the input, with open edges along the cut. Points that nothing uses any more
// are dropped. The order of triangles and points follows that of the input.
TriangleMesh clipToBox(const TriangleMesh& mesh, const openvdb::Mat4d& worldToIndex,
                       const openvdb::Vec3d& low, const openvdb::Vec3d& high);

}  // namespace isowave
