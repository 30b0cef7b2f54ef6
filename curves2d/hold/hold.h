// Levels that hold: what is thinner than a pixel of a level stays whole, by a local change of the level's control points.
//
// Notation. Lengths in pixels of level 0, H = 2^level; F: the spline of the level; r: its curves are sampled on a lattice of
// H/r; x, n, t: place, unit normal and thickness of a thin sample (thin.h).
//   s = 0.45 H/r           half of the thickness that the sampling needs: below 0.75 H/r thin parts tear
//   e = max(0, s - t/2)    by how much a thin part is thickened, each side
// Hard constraints, at the thinnest sample of every cell of H/4:
//   F(x) <= -0.02 H,   F(x + s n) <= 0,   F(x - s n) <= 0
// Soft ones keep the curve where level 0 has it. At one of its points p (normal N) a cell of H/4, at most 1.25 H from a
// sample, with t and e of the nearest:
//   F(p + (e + 0.08 H) N) >= 0   where that point is at least 0.8 (e + 0.08 H) away from the inside: not in another part
//   F(p - 0.08 H N) <= 0         where t/2 - 0.08 H > s
// and, so that nothing swells between the samples,
//   F >= 0                       at points H/2 apart, e + 0.23 H to e + 0.9 H from the inside, at most 1.5 H from a sample
// Dual ascent (ascent.h) over all of them, then over the hard ones alone.
#pragma once

#include <vector>

#include "curves2d/hold/outline.h"
#include "curves2d/hold/thin.h"
#include "curves2d/row_field.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

// The factor r, 1, 2 or 4: the least one at which no more than a twentieth of the samples must be thickened by more than
// half of what they measure. 1 without samples.
int samplingOf(const std::vector<ThinSample>& samples, double H);

// Changes the control points of a level. samples: of that level. Returns how many control points have changed; 0 without
// samples. The same bits for any number of threads. REQUIRES: field.axis == 0, its origin is that of level 0.
std::int64_t holdThin(RowField<float>& field, const Outline& outline, const std::vector<ThinSample>& samples,
                      double H, int sampling, Point spacing, const Progress& progress = {});

}  // namespace isowave::curves2d
