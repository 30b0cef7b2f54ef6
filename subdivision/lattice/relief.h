// A relief as a surface with levels: height fields and point grids on the triangular lattice (B section 11). The two
// layouts of samples are described at ReliefLayout, isowave/subdivision.h.
#pragma once

#include "isowave/subdivision.h"
#include "subdivision/lattice/surface.h"

namespace isowave::subdivision {

// The largest middle part whose sides can be halved `levels` times. Throws InputError when there is none.
SurfaceField reliefField(const Grid& grid, ReliefLayout layout, int levels);

// A picture of a field: the samples where they were (level k has 2^k times fewer a side); quincunx leaves NaN
// outside the hexagon, and fills the samples between with the mean of their neighbours in the row.
Grid reliefPicture(const SurfaceField& field, ReliefLayout layout);

// |detail| at the edge nodes of a level, 0 at vertex nodes (with channels: the length).
// REQUIRES: 0 <= level < levels().
SurfaceField detailField(const SurfaceLevels& levels, int level);

// Light from the upper left on a height field, 0 to 1; `slope` is in values a sample for a 45 degree slope.
Grid shaded(const Grid& heights, double slope);

}  // namespace isowave::subdivision
