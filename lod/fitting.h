// How a field is fitted: which fit, and its options.
#pragma once

#include "isowave/solid.h"
#include "volume/fit.h"
#include "volume/fit/fit_mask.h"

namespace isowave::lod {

struct Fitting {
    FitMethod method;
    DistanceFitOptions distance;
    BinaryFitOptions binary;
    MaskFitOptions mask;
};

}  // namespace isowave::lod
