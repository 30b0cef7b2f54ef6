// Curves put together again, edited and simplified: rebuild() of isowave/subdivision.h.
#pragma once

#include "isowave/subdivision.h"
#include "subdivision/curves/curve_schemes.h"

namespace isowave::subdivision {

// The curve at `level` with `moved` in the place of its coarse one. global: P, Q and the details as they are. local: at each
// level the displacement Q d of every point turns by the angle from the tangent of P c to that of P c', c before and c' after
// the edit; the tangent at a point is the difference of its two neighbours (at an open end: of the end and its neighbour).
// REQUIRES: moved has the size, dimension and closing of the coarse curve; two dimensions for local.
Polyline reconstructEdited(const CurveLevels& curve, const CurveFilters& filters, const Polyline& moved,
                           int level, Frames frames);

// The first point of `base` that lies elsewhere than that of the coarse curves, farther than 1e-6 of their extent: files may
// hold fewer digits.
struct MovedPoint {
    std::size_t curve, point;
    double distance;
};
std::optional<MovedPoint> firstMovedPoint(const CurveSet& set, const std::vector<Polyline>& base);

// Throws InputError where `curves` are not as many as the coarse ones, or one has another size, dimension or closing.
void requireLikeCoarse(const CurveSet& set, const std::vector<Polyline>& curves);

}  // namespace isowave::subdivision
