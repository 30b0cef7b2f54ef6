// Curves, taken apart as `isowave curve-levels` does it: reportCurves() of isowave/subdivision.h.
#pragma once

#include "isowave/subdivision.h"

namespace isowave::subdivision {

// What CurveReport::Curve::compared holds when it was asked for.
inline constexpr const char* kComparedSchemes[] = {"dlg-trial", "dlg-refined", "dlg-optimal"};

}  // namespace isowave::subdivision
