// Signed distances in voxels, the input of fitDistance(), and Node-Collections, the input of fitBinary().
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "isowave/progress.h"
#include "volume/field.h"
#include "isowave/image.h"
#include "io/image/stream.h"
#include "isowave/mesh.h"

namespace isowave {

// Every function below returns a FloatGrid whose transform takes lattice points to the world, with values in
// voxels (index space), negative inside, exact sign at every lattice point, clamped to ±halfWidth; active
// where |value| < halfWidth; inactive voxels and tiles ±halfWidth by sign; background +halfWidth.

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

// With an open border the border's voxels continue this many voxels outwards before the cap; a mesh is then
// cut off at the border itself (clipToBox() in polygonize/clip.h).
inline constexpr int kOpenBorder = 16;

struct ImageSolid {
    double iso = 0.5;     // inside where value > iso
    bool invert = false;  // inside where value < iso
    // Given: inside where value == label (with invert: where it is not) and iso means nothing. For distances, voxels
    // count as 1 where they have the label, as 0 elsewhere, and the surface is at 0.5.
    std::optional<double> label = {};
    bool openBorder = false;  // true: no cap; the border's values continue outwards instead of "outside"
};

// Distances, taken in index space, to the zero set of the voxels' trilinear interpolation (sub-voxel), by
// openvdb::tools::FastSweeping. Throws InputError as linearTransform() does, and as ImageStream::pass() does.
// Of a stream the voxels are read twice: once for the signs, once for the values in the band around the surface.
openvdb::FloatGrid::Ptr distanceFromImage(ImageStream& stream, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress = {});
openvdb::FloatGrid::Ptr distanceFromImage(const Image& image, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress = {});

// A level set of any half-width and any background, to distances in voxels.
openvdb::FloatGrid::Ptr distanceFromLevelSet(const openvdb::FloatGrid& levelSet, double iso, double halfWidth,
                                             const Progress& progress = {});

// f(x) = signed distance in voxels at index-space point x, evaluated at every lattice point of [low, high];
// the rest of space is outside. For tests and analytic solids.
openvdb::FloatGrid::Ptr distanceFromFunction(const std::function<double(const openvdb::Vec3d&)>& f,
                                             const openvdb::CoordBBox& box, double halfWidth);

// Lattice point i is inside where image value > iso (or < with invert), or, with a label, where value ==
// label. The voxels of the image are the lattice points; beyond the border everything is outside, unless
// openBorder. A stream is read once, and gives the same as the whole image, to the bit, whatever its slabs.
NodeCollection nodesFromImage(ImageStream& stream, const ImageSolid& solid, const Progress& progress = {});
NodeCollection nodesFromImage(const Image& image, const ImageSolid& solid, const Progress& progress = {});
NodeCollection nodesFromLabel(const Image& image, double label, bool openBorder = false,
                              const Progress& progress = {});

// The nodes whose corner signs differ. inside: value = inside everywhere (its active states are ignored).
NodeCollection nodesFromSigns(const openvdb::BoolGrid& inside);
NodeCollection nodesFromFunction(const std::function<bool(const openvdb::Coord&)>& inside,
                                 const openvdb::CoordBBox& box);

}  // namespace isowave
