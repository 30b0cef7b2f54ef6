// The four-point rule of Dyn, Levin and Gregory on an open curve: inside, a fine point in the middle of an edge is
// (-1, 9, 9, -1)/16 of the coarse ones around it. Beside an end it is the cubic (quadratic, linear) polynomial through the
// points there are: on the first edge (5, 15, -5, 1)/16 for n >= 4 coarse points, (3, 6, -1)/8 for n = 3, the midpoint for
// n = 2. Curves have it, and so have the boundaries of Butterfly surfaces.
#pragma once

#include "subdivision/filters/diagram.h"

namespace isowave::subdivision {

// What the fine point i of an open four-point curve with n coarse points takes from them.
// REQUIRES: n >= 2, 0 <= i <= 2n - 2.
Diagram fourPointRow(int n, int i);

}  // namespace isowave::subdivision
