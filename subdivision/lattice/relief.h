// A relief as a surface with levels: height fields and point grids on the triangular lattice (B section 11). The two
// layouts of samples are described at ReliefLayout, isowave/subdivision.h.
#pragma once

#include "isowave/subdivision.h"
#include "subdivision/lattice/surface.h"

namespace isowave::subdivision {

// Rows: all of the grid, continued at the right and at the bottom, up to the next sides that can be halved `levels` times, by
// its mirror image about the last column and row. Quincunx: the largest hexagon in the middle whose side can be. Throws
// InputError when the grid is smaller than one node of the coarsest level.
SurfaceField reliefField(const Grid& grid, ReliefLayout layout, int levels);

// The side of that hexagon, in steps of level 0: a multiple of 2^levels, 0 where the grid is too small.
std::size_t quincunxSide(std::size_t rows, std::size_t columns, int levels);

// A picture of a field: the samples where they were (level k has 2^k times fewer a side); quincunx leaves NaN
// outside the hexagon, and fills the samples between with the mean of their neighbours in the row.
Grid reliefPicture(const SurfaceField& field, ReliefLayout layout);

// Which sample of the picture a node of a hexagon is, row by row.
std::size_t quincunxSample(const Patch& hexagon, Node node);

// The first rows and columns of a picture of level `level`: what it has of a grid of that size at level 0, whose sample (r, c)
// is that of level 0 at (r 2^level, c 2^level). A picture that has no more stays as it is.
Grid withoutPadding(Grid picture, const Grid& grid, int level);

// |detail| at the edge nodes of a level, 0 at vertex nodes (with channels: the length).
// REQUIRES: 0 <= level < levels().
SurfaceField detailField(const SurfaceLevels& levels, int level);

// Light from the upper left on a height field, 0 to 1; `slope` is in values a sample for a 45 degree slope.
Grid shaded(const Grid& heights, double slope);

}  // namespace isowave::subdivision
