// Signed distances from a closed mesh, as volume/distance.h has them, and the lattice for it.
#pragma once

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/vdb.h"

namespace isowave {

// mesh: closed (repairMesh). transform: index -> world, uniform scale. halfWidth >= 1, in voxels.
// Distances are exact, to float32's rounding: every lattice point of the band asks a hierarchy of boxes for
// its nearest triangle. Signs are winding numbers with respect to the mesh (nested voids are outside, parts
// that overlap are one solid), by LatticeLines of volume/mesh_winding.h, which no ray slips through. A
// lattice point on the surface gets 2^-20 of either sign, never 0.
// Surface that is buried in the solid (parts overlap or touch) leaves no dent: inside points ignore it, and
// are short of the distance to the solid's own surface by at most 2.3 voxels there.
// evenOdd: count crossings instead of winding, for meshes whose orientation cannot be trusted
// (MeshRepairReport::evenOdd).
// Throws InputError: mesh not closed, or more than 2^20 voxels across.
//
// Left: openvdb::tools::meshToVolume. It hands the nearest triangle on from neighbour to neighbour, and is up
// to 1.09 voxels off for 2 % of the points around a sphere's mesh, all beyond 1.5 voxels; its signs fill
// nested voids; and it is no faster (heatsink, 545,936 triangles, 256 voxels, 2 cores: 0.9 s, here 0.5 s).
openvdb::FloatGrid::Ptr distanceFromMesh(const TriangleMesh& mesh, const openvdb::math::Transform& transform,
                                         double halfWidth, bool evenOdd = false,
                                         const Progress& progress = {});

// Signed distances from the solid of all points nearer to `mesh` than half of `thickness`: the distance to the mesh less
// thickness / 2. mesh: open or closed, its orientation means nothing; thickness: in the mesh's units, above 0. A sheet becomes
// a plate, a closed mesh a shell. Otherwise as above.
openvdb::FloatGrid::Ptr distanceAroundMesh(const TriangleMesh& mesh,
                                           const openvdb::math::Transform& transform, double halfWidth,
                                           double thickness, const Progress& progress = {});

// Voxel size, in the mesh's units, for which the mesh's longest axis spans `voxels` voxels.
// REQUIRES: voxels > 0, a mesh of non-zero extent (repairMesh).
double voxelForCount(const TriangleMesh& mesh, double voxels);

// The lattice for a mesh: cubes of edge `voxel`, axes along the world's. The low corner of the mesh's
// bounding box gets index coordinates (f, f, f), f = (3 - sqrt 5)/2 = 0.382. f is irrational and far from 0
// and 1: with a whole number of voxels across, faces at any rational fraction of the extent keep clear of
// lattice planes, where distances would be 0 and signs a matter of taste. REQUIRES: voxel > 0.
// Throws InputError as linearTransform() (volume/linear_transform.h) does: voxel below 1.5e-5.
openvdb::math::Transform::Ptr transformForMesh(const TriangleMesh& mesh, double voxel);

// How many lattice points distanceFromMesh will hold active, before it is run: area / voxel^2 * 2 halfWidth,
// but no more than the bounding box, widened by halfWidth, has. Measured: 1.0 (sphere) to 1.4 (thin fins,
// whose bands overlap) times the truth. Each takes 8 to 11 bytes of the grid returned.
double estimateBandVoxels(const TriangleMesh& mesh, double voxel, double halfWidth);

}  // namespace isowave
