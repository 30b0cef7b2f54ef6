// One direction: every line of a field along one axis, each of its intervals analysed on its own, in
// parallel.
//
// Threads own columns of leaves (leaves that share the two other coordinates); a fine column maps to one
// coarse column, so no two threads write to the same leaf and the result does not depend on their number, to
// the bit.
#pragma once

#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave::wavelets {

// Details of a step: active = stored, at the coarse lattice position of interval.h. 0 elsewhere.
using DetailGrid = openvdb::FloatGrid;

struct DirectionResult {
    BSplineField coarse;  // transform scaled by 2 along the axis; nothing shifts
    DetailGrid::Ptr details;
};

// axis: 0, 1, 2 = x, y, z. REQUIRES: every run of known control points along the axis has length >= 4.
DirectionResult analyseDirection(const BSplineField& fine, int axis, const Progress& progress = {});

// The inverse; fineShape is the shape that the fine field had.
BSplineField synthesiseDirection(const BSplineField& coarse, const DetailGrid& details,
                                 const Shape& fineShape, int axis, const Progress& progress = {});

// How far errors spread (wavelets/bounds.h says why). coarse: a field of K = 0 whose control points are how
// far those of a coarse field move at most, either way; details: likewise. Returns, as a field of K = 0, how
// far each fine control point moves at most. For errors that are known by their size only: rounding,
// quantisation.
BSplineField boundDirection(const BSplineField& coarse, const DetailGrid& details, const Shape& fineShape,
                            int axis, const Progress& progress = {});

}  // namespace isowave::wavelets
