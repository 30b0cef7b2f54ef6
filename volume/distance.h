// Signed distances in voxels, the input of fitDistance(), and Node-Collections, the input of fitBinary().
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "base/progress.h"
#include "volume/field.h"
#include "volume/image.h"
#include "volume/triangle_mesh.h"

namespace isowave {

// Every function below returns a FloatGrid whose transform takes lattice points to the world, with values in
// voxels (index space), negative inside, exact sign at every lattice point, clamped to ±halfWidth; active where
// |value| < halfWidth; inactive voxels and tiles ±halfWidth by sign; background +halfWidth.

// mesh: closed (repairMesh). transform: index -> world, uniform scale. Distances by openvdb::tools::meshToVolume;
// the sign of a lattice point is its winding number with respect to the mesh (nested voids are outside), found
// on exact fixed-point coordinates, so that a ray never slips between two triangles.
// evenOdd: count crossings instead of winding, for meshes whose orientation was not consistent as read.
openvdb::FloatGrid::Ptr distanceFromMesh(const TriangleMesh& mesh, const openvdb::math::Transform& transform,
                                         double halfWidth, bool evenOdd = false, const Progress& progress = {});

struct ImageSolid {
    double iso = 0.5;          // inside where value > iso
    bool invert = false;       // inside where value < iso
    bool openBorder = false;   // true: no cap; the border's values continue outwards instead of "outside"
};

// Distances, taken in index space, to the zero set of the voxels' trilinear interpolation (sub-voxel), by
// openvdb::tools::FastSweeping.
openvdb::FloatGrid::Ptr distanceFromImage(const Image& image, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress = {});

// A level set of any half-width and any background, to distances in voxels.
openvdb::FloatGrid::Ptr distanceFromLevelSet(const openvdb::FloatGrid& levelSet, double iso, double halfWidth,
                                             const Progress& progress = {});

// f(x) = signed distance in voxels at index-space point x, evaluated at every lattice point of [low, high]; the
// rest of space is outside. For tests and analytic solids.
openvdb::FloatGrid::Ptr distanceFromFunction(const std::function<double(const openvdb::Vec3d&)>& f,
                                             const openvdb::CoordBBox& box, double halfWidth);

// Lattice point i is inside where image value > iso (or < with invert), or, with a label, where value == label.
// The voxels of the image are the lattice points; beyond the border everything is outside, unless openBorder.
NodeCollection nodesFromImage(const Image& image, const ImageSolid& solid, const Progress& progress = {});
NodeCollection nodesFromLabel(const Image& image, double label, bool openBorder = false, const Progress& progress = {});

// The nodes whose corner signs differ. inside: value = inside everywhere (its active states are ignored).
NodeCollection nodesFromSigns(const openvdb::BoolGrid& inside);
NodeCollection nodesFromFunction(const std::function<bool(const openvdb::Coord&)>& inside,
                                 const openvdb::CoordBBox& box);

}  // namespace isowave
