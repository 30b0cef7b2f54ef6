// Signed distances, as volume/distance.h has them, from images, level sets and functions.
#pragma once

#include <functional>

#include "io/image/stream.h"
#include "isowave/image.h"
#include "isowave/progress.h"
#include "volume/image_solid.h"
#include "volume/vdb.h"

namespace isowave {

// Distances, taken in index space, to the zero set of the voxels' trilinear interpolation (sub-voxel), from the crossings of
// lattice edges (distance/crossing_band.h). Throws InputError as linearTransform() does, and as ImageStream::pass() does.
// Of a stream the voxels are read twice: once for the signs, once for the values in the band around the
// surface.
// allow: is told, between the two, how many lattice points the leaves of the band hold, kBytesPerLeafPoint each, and throws
// where that is too many.
// Seen beside the 60 MB of the program and voxels kept: 4.1 and 5.7 (a part in 512^3 and 256^3 voxels), 6.1 and 6.6 (heads).
inline constexpr double kBytesPerLeafPoint = 7;
openvdb::FloatGrid::Ptr distanceFromImage(ImageStream& stream, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress = {},
                                          const std::function<void(std::int64_t points)>& allow = {});
openvdb::FloatGrid::Ptr distanceFromImage(const Image& image, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress = {});

// A level set of any half-width and any background, to distances in voxels.
openvdb::FloatGrid::Ptr distanceFromLevelSet(const openvdb::FloatGrid& levelSet, double iso, double halfWidth,
                                             const Progress& progress = {});

// f(x) = signed distance in voxels at index-space point x, evaluated at every lattice point of [low, high];
// the rest of space is outside. For tests and analytic solids.
openvdb::FloatGrid::Ptr distanceFromFunction(const std::function<double(const openvdb::Vec3d&)>& f,
                                             const openvdb::CoordBBox& box, double halfWidth);

}  // namespace isowave
