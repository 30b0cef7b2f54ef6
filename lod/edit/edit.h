// A pyramid and edits -> a pyramid (isowave/pyramid.h).
//
// The edits change the field of level 0, one after the other (unite.h, replace.h); it is analysed again at the end, and the pyramid
// keeps it to the bit (wavelets/exact.h).
#pragma once

#include <string>

#include "isowave/pyramid.h"

namespace isowave::lod {

// "--add ball:0,0,0,5", "--move 0,0,0:1,1,1 by 0,0,5", "--with old.pyramid.vdb": what messages and reports call it.
std::string textOf(const Edit& edit);

}  // namespace isowave::lod
