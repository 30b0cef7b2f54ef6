// Voxels whose last axis is the fastest in the file, as arrays in C order have them.
#pragma once

#include "io/image/source.h"

namespace isowave::imageio {

// The source with its axes in reverse order: its voxel (k, j, i) becomes (i, j, k), and size, spacing and axes with it. It is
// read as a whole, a few of the other one's slices at a time. REQUIRES: source->native.
SourcePtr withAxesReversed(SourcePtr source);

}  // namespace isowave::imageio
