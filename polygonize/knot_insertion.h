// A field on a lattice twice as fine: the same function with more control points.
#pragma once

#include <array>

#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave {

// The same function on a lattice twice as fine on each axis, by knot insertion: evaluate(insertKnots(f), 2x)
// = evaluate(f, x) to float32 rounding of the new control points, and world positions stay. On each axis,
// with c coarse and coarse j at fine 2j,
//   fine 2i = (c[i-1] + 6 c[i] + c[i+1]) / 8,   fine 2i+1 = (c[i] + c[i+1]) / 2.
// I becomes the control points that depend on one in I (or are no longer constant); K stays. Signs of the
// shape are those of F at the fine lattice points, there being no input between the coarse ones.
BSplineField insertKnots(const BSplineField& field, const Progress& progress = {});

// The same on some of the axes.
using AxisChoice = std::array<bool, 3>;
BSplineField insertKnots(const BSplineField& field, const AxisChoice& axes, const Progress& progress = {});

// The same, on the blocks of 8^3 fine lattice points on whose cells F = iso can be and on the blocks around those; elsewhere
// K or -K, the side that F - iso has there. So { F = iso } is the same to the bit, and most of the price of a fine lattice,
// which is paid away from the surface, is saved (docs/performance.md). No control point is active, and there is no shape.
// REQUIRES: |iso| < K.
BSplineField insertKnotsAtSurface(const BSplineField& field, double iso, const Progress& progress = {});

// And again, `times` on each axis: onto a lattice 2^times as fine. No times: the field itself.
BSplineField insertKnots(BSplineField field, std::array<int, 3> times, const Progress& progress = {});

// The shape of a field that has none yet: known where control points are active, inside where F < 0 at the lattice point.
Shape::Ptr shapeOf(const openvdb::FloatGrid& controlPoints, const Progress& progress = {});

}  // namespace isowave
