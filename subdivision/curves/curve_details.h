// The file of curves that were taken apart: curveDetailsBytes() and loadCurveDetails() of isowave/subdivision.h.
//
// Sections (base/section_file.h, magic "ISOWCURV"), coarse before fine:
//   1 head     text scheme ("" where there is a mask), text mask, i32 width, u32 levels, u64 length of the sizes, inflated
//   2 sizes    a zlib stream of varints: curves, then for each  2 dimension + closed, levels, points of the coarsest level, of
//              the next finer one, ..
//   3 coarse   the coordinates of all coarse curves, one curve after the other, as deflatedDoubles()
//   4 details  one section a level, the coarsest first (it leads from level `levels` to the one below): of all curves that have it
#pragma once

#include <string>
#include <string_view>

#include "isowave/subdivision.h"
#include "subdivision/curves/curve_schemes.h"

namespace isowave::subdivision {

inline constexpr std::string_view kCurveDetailsMagic = "ISOWCURV";

// name: stands in messages. Throws InputError.
CurveSet readCurveDetails(std::string_view bytes, const std::string& name);

// The scheme of a set. Throws InputError.
CurveScheme schemeOf(const CurveSet& set);

}  // namespace isowave::subdivision
