// Step 0 to the bit: what synthesis misses of it by rounding.
//
// Coarsest field and details are float32, so that synthesis gives step 0 back to about 1e-6 K (docs/wavelets.md). A solid that is
// edited in one place shall be what it was everywhere else, to the bit; but its coarsest field is another one, and what is
// computed from that has other roundings everywhere. So a pyramid may carry the control points of step 0 where the two differ, and
// Pyramid::field(0) puts them in their places.
#pragma once

#include "volume/field.h"

namespace isowave::wavelets {

// The control points of `wanted` where those of `found`, which has the same shape, are other ones: active there. Null where none is.
openvdb::FloatGrid::Ptr missedOf(const BSplineField& wanted, const BSplineField& found);

// Puts them into `found`.
void restore(const openvdb::FloatGrid& missed, BSplineField& found);

// Whether two fields have the same control points and signs everywhere, to the bit.
bool areSame(const BSplineField& a, const BSplineField& b);

}  // namespace isowave::wavelets
