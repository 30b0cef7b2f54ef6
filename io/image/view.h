// Voxels in memory of the caller's, in whatever order they lie there, as a source that copies a slab at a time.
#pragma once

#include "io/image/source.h"
#include "isowave/image.h"

namespace isowave::imageio {

// What messages and reports call it.
inline constexpr const char* kViewName = "array";

// REQUIRES: the memory outlives the source. Throws InputError: an unknown type, a size below 1 or beyond what is handled, a
// voxel size that is not positive, directions that cannot be inverted, a place that is not finite.
SourcePtr openView(const VoxelView& view);

// Whether the voxels lie as a source of the view's type hands them out: x fastest, without gaps, aligned, in this machine's byte order.
bool liesAsRead(const VoxelView& view);

}  // namespace isowave::imageio
