// Levels that hold: what is thinner than a pixel of a level stays whole, by a local change of control points.
//
// Notation. Lengths in pixels of level 0. H = 2^level: a pixel of the level; F: its spline, by knot insertion on a lattice of
// h = H/r (samplingOf), whose control points are changed; x, n, t: place, unit normal and thickness of a thin sample (thin.h).
//   s = 0.45 h             half of the thickness that sampling at h needs: what is thinner than 0.75 h tears
//   e = max(0, s - t/2)    by how much a thin place is thickened, each side
// Hard constraints, at the thinnest sample of every cell of h/4:
//   F(x) <= -0.1 h,   F(x + s n) <= 0,   F(x - s n) <= 0
// Soft ones keep the curve where level 0 has it. At one of its points p (normal N) a cell of h/4, at most 1.25 H from a
// sample, with t and e of the nearest:
//   F(p + (e + 0.02 h) N) >= 0   where that point is at least 0.8 (e + 0.02 h) away from the inside: not in another part
//   F(p - 0.02 h N) <= 0         where t/2 - 0.02 h > s
// and, so that nothing swells between the samples,
//   F >= 0                       at points h/2 apart, e + 0.17 h to e + 0.9 h from the inside, at most 1.5 H from a sample
// Dual ascent (ascent.h) over all of them, then over the hard ones alone.
//
// Why h and not H. With control points H apart, margins of 0.08 H and softness 0.1 (what suits solids), two strokes nearer
// than 2 H to each other cannot both keep their width: a giraffe at level 5 grew by 24 % where it now grows by 0.5 %, a fern
// at level 3 by 7.5 % (now -0.1), a ring of keys at level 3 by 73 % (now 5).
#pragma once

#include <vector>

#include "curves2d/hold/outline.h"
#include "curves2d/hold/thin.h"
#include "curves2d/row_field.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

// r, 1, 2 or 4: the least one at which no more than a fiftieth of the samples is thinner than 2 s. 1 without samples.
int samplingOf(const std::vector<ThinSample>& samples, double H);

struct HoldTask {
    const Outline& outline;                  // of level 0
    const std::vector<ThinSample>& samples;  // of the level
    double H, spacing;                       // of the level, and h
};

// Changes control points of a level; none without samples. The same bits for any number of threads.
// REQUIRES: field.axis == 0, its lattice has the origin of level 0 and the task's spacing.
void holdThin(RowField<float>& field, const HoldTask& task, const Progress& progress = {});

// Once more for samples that curves straight between the lattice's lines leave out: F(x) <= -depth h at each, 0 < depth.
void deepen(RowField<float>& field, const HoldTask& task, double depth, const Progress& progress = {});

}  // namespace isowave::curves2d
