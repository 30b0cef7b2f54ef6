// Polygons added to a fitted shape, or cut out of it: edited() of isowave/curves.h. The twin for solids is lod/edit.
//
// F is the spline of level 0, T that of the tool: fitted by distance on the lattice of the level that was named, refined to
// F's lattice by knot insertion (the same function), in units of F's K. u and t are their values at lattice points, ±K where
// nothing is known.
//
//   tool     rasterise -> fit at the level -> refine -> shift into F's lattice
//   combine  u' = min(u, t) to add, max(u, -t) to cut; u where t >= K, -K or K where t <= -K; inside' = u' < 0
//   known    nodes that inside' stabs, F's nodes at whose corners u' = u, and of both those with a corner of |u'| below the band
//   fit      c' = c where u' = u all around; else the quasi-interpolant (8, -1)/6 of u'; then the repair of the fits
//
// (1) Control points whose neighbours' values did not change are the old ones to the bit, unless the repair reaches them.
// (2) After it F' has the sign of inside' at every lattice point.
// Where control points would lie below -1 (fit.h) the lattice moves by a power of two that is larger than the domain, so
// that the lattices of all coarser levels stay where they are.
#pragma once

#include "curves2d/fit.h"
#include "isowave/curves.h"

namespace isowave::curves2d {

// Nothing where no value changes. REQUIRES: rows along x. Throws InputError, without a name: the tool covers no pixel's middle
// at its level or reaches far away, nothing would be left, shape and tool take more rows or positions than there can be.
std::optional<Fitted> editedFit(const Fitted& fitted, const PolygonEdit& edit, const Progress& progress = {});

}  // namespace isowave::curves2d
