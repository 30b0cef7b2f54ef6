// The planar wavelet pyramid: directions x, y, x, y, ... are halved until one node is left, 16 control points. Step s has
// halved x ceil(s/2) times and y floor(s/2) times; level l is step 2l. stepName() gives their names, L0, L0a, L1, ...
#pragma once

#include <functional>

#include "curves2d/direction.h"

namespace isowave::curves2d {

template <class Real>
struct Pyramid {
    std::vector<Step<Real>> steps;  // finest first
    RowField<Real> coarsest;

    int stepCount() const { return static_cast<int>(steps.size()); }
    // Synthesised from the coarsest: the field at a step, 0 = finest. Rows run along the axis that the next
    // step would halve. REQUIRES: 0 <= step <= stepCount().
    RowField<Real> field(int step, const Progress& progress = {}) const;
    // What the wavelet transform holds: the coarsest control points and all details.
    std::int64_t coefficientCount() const;
};

// Called with every field on the way down, the finest first, the coarsest last.
template <class Real>
using StepVisitor = std::function<void(int step, const RowField<Real>& field)>;

// Takes steps until one node is left, at most `mostSteps` of them.
// Largest error of pyramid.field(0): 1e-5 K for float, 1e-12 K for double, whatever the number of steps.
// REQUIRES: no known control point lies below -1 on either axis (fit.h sees to it; elsewhere a domain that
// straddles the origin would halve to -2 .. 2 and stay there).
template <class Real>
Pyramid<Real> analyse(RowField<Real> field, int mostSteps = 1000, const Progress& progress = {},
                      const StepVisitor<Real>& visit = {});

}  // namespace isowave::curves2d
