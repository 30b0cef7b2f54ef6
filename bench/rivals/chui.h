// Chui's way with the same wavelets: one filter for all, on a line without ends. Its analysis filters are infinite and
// have to be cut (Esteve, Brunet, Vinacua, section 3).
#pragma once

#include <vector>

#include "volume/field.h"

namespace isowave::bench {

// The dual filters of the cubic B-spline and of its wavelet, 2 reach + 1 taps each: c_j = sum a[s] f(2j + s),
// d_j = sum b[s] f(2j + 1 + s), s = -reach .. reach.
struct AnalysisFilters {
    int reach;
    std::vector<double> a, b;
};
AnalysisFilters cutFilters(int reach);

struct RoundTripError {
    double max = 0, rms = 0;  // over the control points of the field, in K
};

// `steps` directions, x, y, z in turn, of the dense field (all lattice points, ±K where nothing is known), there and
// back in double: what the cut costs.
RoundTripError cutRoundTrip(const BSplineField& field, int steps, const AnalysisFilters& filters);

}  // namespace isowave::bench
