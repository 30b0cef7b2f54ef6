// Polygons -> the lattice points inside them, exactly.
#pragma once

#include "curves2d/geometry.h"
#include "curves2d/spans.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

// Square pixels, `pixels` of them along the longer side of the polygons' bounding box; lattice point (i, j)
// is the middle of pixel (i, j), and pixel (0, 0) lies in the box's lower corner.
// Throws InputError when the polygons have no extent. REQUIRES: pixels >= 1.
Frame frameAround(const std::vector<Polygon>& polygons, std::int32_t pixels);

// The lattice points inside at least one polygon. Inside a polygon = inside an odd number of its rings, so
// direction and order of the rings do not matter and a ring that crosses itself has an answer too.
//
// Exact: coordinates are rounded to 2^-20 of a lattice step and everything after that is done in integers. A
// lattice point on an edge belongs to exactly one of the two sides (a point is inside from the crossing at
// its left, included, to the crossing at its right, not included), so polygons that share an edge leave no
// slit and do not overlap. Memory: proportional to the boundary, whatever the size of the lattice. Throws
// InputError for coordinates beyond 2^28 lattice steps.
Region rasterise(const std::vector<Polygon>& polygons, const Frame& frame, const Progress& progress = {});

// The edges of all rings in lattice coordinates. Edges that occur twice, in two polygons or in one, are
// borders between two insides and left out.
std::vector<Segment> boundary(const std::vector<Polygon>& polygons, const Frame& frame);

}  // namespace isowave::curves2d
