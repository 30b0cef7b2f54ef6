// A pyramid that gives its step 0 back to the bit.
#pragma once

#include "wavelets/pyramid.h"

namespace isowave::wavelets {

// From now on pyramid.field(0) is `field`, to the bit: exact.h says how. REQUIRES: pyramid = analyse(field).
void keepExactly(Pyramid& pyramid, const BSplineField& field, const Progress& progress = {});

}  // namespace isowave::wavelets
