// A field -> the closed curves where its spline is zero.
//
// The zero set of the spline itself, not of an interpolation between lattice values: where the spline's signs
// differ at the two ends of a lattice edge, the curve crosses the edge at a root of a cubic in one variable.
// Promises:
//   (1) every crossing is a root to 1e-12 of the edge, then kept 1e-3 of the edge away from lattice points
//   (2) rings are closed, simple, pairwise disjoint; inside lies to the left: outer rings run
//       counter-clockwise, holes clockwise (positive and negative area; y pointing up)
//   (3) every ring has a lattice point inside, every lattice edge at most one crossing
//   (4) the same rings in the same order each time
// (2) holds for every pattern of signs: in a unit square the pieces are straight and cut off corners, so they
// meet neither each other nor themselves, and squares meet in edges only.
#pragma once

#include "curves2d/row_field.h"
#include "isowave/curves.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

template <class Real>
Curves extractCurves(const RowField<Real>& field, const Progress& progress = {});

// The same rings with more points, all on the zero set, until no piece is further than `tolerance` (input's
// units) from the zero set by the estimate |F|/|grad F|. Rings stay simple: points that are added lie inside
// the unit square of their piece, and a piece is left straight where they would cross or where its square
// holds two pieces.
template <class Real>
Curves refined(const RowField<Real>& field, const Curves& curves, double tolerance);

// Cubic Béziers through the crossings along the zero set's tangents, halved at points of the zero set until
// they stay within `tolerance` of it (input's units; estimate |F|/|grad F| at seven points of each).
template <class Real>
SmoothCurves smoothed(const RowField<Real>& field, const Curves& curves, double tolerance);

}  // namespace isowave::curves2d
