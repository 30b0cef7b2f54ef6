// Curves as points with levels: take apart, threshold, edit, put together.
//
//   level 0 is the given curve, level k the one after k decompositions.
//   decompose:    points(k+1) = A points(k),  details[k] = B points(k)
//   reconstruct:  points(k) = P points(k+1) + Q details[k]
//
// (1) reconstruct(decompose(c)) differs from c by at most 1e-14 times the largest number stored (coarse points and
//     details), for every scheme, size and depth; and by at most kCurveRoundTrip * max|c| up to 10 levels and, but for
//     long and rough curves of cubic-3, beyond. Those store numbers that outgrow the curve: the narrow A multiplies
//     noise by sqrt((5 + sqrt 153)/4) = 2.084 a level (1e-10 after 20 levels of 1,000,003 points).
// (2) The numbers stored (coarse points and details of all levels) are as many as the curve has.
// (3) Time is linear in the number of points: every level costs half of the one before.
#pragma once

#include <cstddef>

#include "isowave/subdivision.h"
#include "subdivision/curves/curve_schemes.h"

namespace isowave::subdivision {

// Throws InputError when the curve has too few points (and says how many are needed), a coordinate is not finite (and
// names the point), or the curve is open and the filters are for closed ones, or the other way round.
CurveLevels decompose(const Polyline& curve, const CurveFilters& filters, int levels);

// The curve at `level` (0: as it was). Throws InputError when scheme, sizes or levels do not belong together.
Polyline reconstruct(const CurveLevels& curve, const CurveFilters& filters, int level = 0);

// What P alone makes of level `from`: all finer details are taken for 0. From the coarsest this is P^k V0 of O section 5.
Polyline subdivided(const CurveLevels& curve, const CurveFilters& filters, int from);

// Puts `points` in the place of the curve at `level`; details finer than that stay, so they ride on the new
// shape. Throws InputError when the number of points, the dimension or the closing is another one.
void edit(CurveLevels& curve, const CurveFilters& filters, int level, const Polyline& points);

// ||a - b||_2: the root of the sum of squared distances, point by point. REQUIRES: same size and dimension.
double l2Distance(const Polyline& a, const Polyline& b);

// `count` points at equal steps of arc length. REQUIRES: count >= 2, a length above 0.
Polyline resampled(const Polyline& curve, std::size_t count);

// One linear map of a scheme, applied to points of `dimension` numbers: out (+)= bank in. For tests and
// benchmarks.
void applyBank(const FilterBank& bank, int dimension, const double* in, std::size_t inputs, double* out,
               std::size_t outputs, bool accumulate);

}  // namespace isowave::subdivision
