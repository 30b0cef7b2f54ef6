// Other values for accessory control points than ±K by sign.
#pragma once

#include <string>

#include "wavelets/direction.h"

namespace isowave::bench {

enum class AccessoryRule {
    sign,     // ±K: isowave's, and the paper's
    end,      // the value of the nearest known control point; beyond an end, and in a gap that was joined
    average,  // the mean of the interval's known control points
};
std::string nameOf(AccessoryRule rule);

// analyseDirection() with another rule, one interval at a time. Which control points and details there are does not
// depend on it.
wavelets::DirectionResult analyseWith(AccessoryRule rule, const BSplineField& fine, int axis);

// What getting one interval back takes under a rule, for n coarse intervals. With a known value beyond the ends the
// rejected coefficients follow from it; otherwise the accessory points are unknown as well, and equal to what the rule
// makes of the unknown result.
struct Recovery {
    double condition;  // of the 8x8 system for the rejected coefficients, in the infinity norm
    double norm;       // of coefficients -> control points: errors of coefficients grow by this
};
Recovery recoveryOf(AccessoryRule rule, int n);

}  // namespace isowave::bench
