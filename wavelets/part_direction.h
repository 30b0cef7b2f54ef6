// One direction of a part of a field (volume/parts/field_part.h), which has whole lines along it.
#pragma once

#include "volume/parts/field_part.h"
#include "wavelets/direction.h"

namespace isowave::wavelets {

// analyseDirection() of the field, as far as the part reaches: values are computed line by line. REQUIRES: the part's box is not
// cut along the axis.
DirectionResult analysePart(const BSplineField& part, int axis, const Progress& progress = {});

}  // namespace isowave::wavelets
