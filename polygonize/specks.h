// Specks and bubbles: components of a level's mesh that are smaller than the level can show. A wavelet step
// rings beside details that it cannot represent, and a thin wall that tears leaves small pieces, so that a
// coarse level has parts and cavities that the solid does not have. They are removed from the mesh, never
// from the field: the pyramid still restores every finer step.
#pragma once

#include <cstdint>
#include <vector>

#include "base/point_box.h"
#include "polygonize/topology.h"
#include "volume/vdb.h"

namespace isowave {

// One node of a step, in world units^3: the cube between 2^3 lattice points.
double nodeVolume(const openvdb::math::Transform& transform);

struct SpeckRemoval {
    std::int64_t specks = 0, bubbles = 0;      // components that bounded a part, a cavity
    double speckVolume = 0, bubbleVolume = 0;  // world units^3, both >= 0
    std::vector<PointBox> boxes;               // around each of them
};

// true: the component with this signed volume (MeshComponents::volume) is a speck or a bubble: |volume| <
// smallest, and it is not the largest part. So a solid that has become smaller than a node, as every solid
// does in the end, is still there: whether a level has vanished is for the field to say.
std::vector<bool> areSpecks(const std::vector<double>& volumes, double smallest);

// Takes the specks and bubbles out of a closed mesh; points and triangles that stay keep their order.
// (1) Inside and outside stay consistent: what lies in a component that goes is smaller than it, and goes
// too.
// (2) The mesh that stays is as closed, manifold and oriented as it was: whole components go.
// (3) The largest part stays, whatever its size.
SpeckRemoval removeSpecks(TriangleMesh& mesh, double smallest);
// components: the mesh's, before and afterwards.
SpeckRemoval removeSpecks(TriangleMesh& mesh, double smallest, MeshComponents& components);
// The same where what is too small differs from place to place: of a component it is the least of its points'.
// REQUIRES: smallestAt has one value a point.
SpeckRemoval removeSpecks(TriangleMesh& mesh, const std::vector<double>& smallestAt);

// Volume of the mesh that removeSpecks() would leave.
double volumeWithoutSpecks(const TriangleMesh& mesh, double smallest);

}  // namespace isowave
