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

#include <vector>

#include "isowave/progress.h"
#include "curves2d/row_field.h"

namespace isowave::curves2d {

struct CurveRing {
    Ring points;  // lattice coordinates
    int parent =
        -1;  // the ring directly around it: of a hole its outer ring, of an island in a hole the hole
    bool hole = false;
};

struct Curves {
    Frame frame;  // of the lattice
    std::vector<CurveRing> rings;

    // In the input's coordinates.
    Ring world(std::size_t ring) const;
    std::size_t outerCount() const;
    std::size_t holeCount() const;
    std::size_t pointCount() const;
    // Outer rings less holes, in the input's unit squared.
    double area() const;
};

template <class Real>
Curves extractCurves(const RowField<Real>& field, const Progress& progress = {});

// The same rings with more points, all on the zero set, until no piece is further than `tolerance` (input's
// units) from the zero set by the estimate |F|/|grad F|. Rings stay simple: points that are added lie inside
// the unit square of their piece, and a piece is left straight where they would cross or where its square
// holds two pieces.
template <class Real>
Curves refined(const RowField<Real>& field, const Curves& curves, double tolerance);

struct Bezier {
    Point start, startHandle, endHandle, end;  // the input's coordinates
    Point at(double t) const;
};

struct SmoothCurves {
    std::vector<std::vector<Bezier>> rings;  // in the order of Curves::rings
    double deviation = 0;                    // the largest distance from the zero set that was seen
    std::size_t straightPieces = 0;          // pieces left straight because no halving would do
};

// Cubic Béziers through the crossings along the zero set's tangents, halved at points of the zero set until
// they stay within `tolerance` of it (input's units; estimate |F|/|grad F| at seven points of each).
template <class Real>
SmoothCurves smoothed(const RowField<Real>& field, const Curves& curves, double tolerance);

}  // namespace isowave::curves2d
