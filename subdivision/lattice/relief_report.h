// A relief, taken apart as `isowave relief` does it (B section 11): reportRelief() and forEachPicture() of
// isowave/subdivision.h.
#pragma once

#include "isowave/subdivision.h"
