// What a hierarchy is for: moving its base with the details riding along, and leaving details out
// (reconstructEdited(), threshold(), keepLongest() of isowave/subdivision.h).
#pragma once

#include "isowave/subdivision.h"

namespace isowave::subdivision {

// No details: what subdivision alone makes of the base.
void clearDetails(Hierarchy& hierarchy);

}  // namespace isowave::subdivision
