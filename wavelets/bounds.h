// How far a field moves when details do: leaving small details out, or storing them with fewer bits, with a
// bound that is known.
//
// Notation (interval.h): an interval's synthesis is f = Mc c + Md d + Ma a, a the accessory values. Those are
// known, so moving c and d by at most x and y moves f by at most |Mc| x + |Md| y, absolute values taken entry
// by entry. In the infinity norm, by class of interval (bounds_test repeats it; both norms grow with n up to
// a limit, but for n = 1):
//
//   n        1       2       3       4       >= 5
//   ||Mc||   1.8579  1.8543  1.8543  1.8543  1.8543
//   ||Md||   0.6969  1.5105  1.6501  1.6608  1.6624
//
// Inside an interval ||Mc|| is that of P: 1. It is larger at the first and last four control points alone,
// where the recovered coefficients have a say. So, for any field, with e_s how far a control point of step s
// moves at most and y_s how far a detail of step s does,
//   (1) e_s <= kCoarseGain e_(s+1) + kDetailGain y_s,  so that  e_0 <= kDetailGain sum of kCoarseGain^s y_s.
// That is worth something for a few steps only: 1.86^18 = 70,000, all 18 directions taken at an end of an
// interval.
//   (2) The same, control point by control point: boundDirection() is (1) with every entry of |Mc| and |Md| in its place
//       and with the details that really moved. bounds_test shows what is seen beside it.
// What is seen for details that are known needs no bound: synthesis is linear, so the change is the synthesis
// of theirs. F moves nowhere by more than the control points: B-splines are >= 0 and add up to 1. Its zero
// set moves by about e_0 over the slope, which a distance fit makes K / half-width a voxel: 0.01 K is 0.04
// voxel with the default of 4.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "isowave/progress.h"
#include "wavelets/pyramid.h"

namespace isowave::wavelets {

// Largest ||Mc|| and ||Md|| of all intervals, rounded up.
inline constexpr double kCoarseGain = 1.8580, kDetailGain = 1.6625;

struct DroppedDetails {
    std::int64_t details = 0;  // of all steps
    std::int64_t dropped = 0;  // of these, how many were too small
    // moved[s], 0 <= s <= stepCount(): the largest change of a control point of step s; its field changes
    // nowhere by more. Up to the rounding of float32 that any two ways to one field may show, 1e-6 K.
    std::vector<double> moved;
    // bound[s] >= moved[s]: what (2) above allows other details of the same sizes.
    std::vector<double> bound;
};

// Sets to 0 what is smaller than below[s] (in magnitude; in the field's units, K or part of it) among the
// details of step s; infinity: all of them. They stay stored, as zeros: the pyramid's shapes do not change.
// With all details of the k finest steps dropped, field(0) is field(k) seen on the fine lattice, P P .. P c,
// except within six control points of an end of an interval, where the known accessory values pull.
// REQUIRES: details and shapes of all steps; below.size() == stepCount().
DroppedDetails dropDetails(Pyramid& pyramid, std::span<const double> below, const Progress& progress = {});

}  // namespace isowave::wavelets
