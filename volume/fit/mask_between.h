// Whether a spline has, between lattice points, the sign that they agree on.
#pragma once

#include "volume/fit/mask_band.h"

namespace isowave::fitting {

// For each of a leaf's lattice points, what |F| lacks around it: the most that target - s F is over the middles of the edges, faces and cells that
// have it as a corner and whose corners all have its sign s, where s F < floor; else 0.
// c: control points. D: negative inside.
void lackingBetween(const PaddedLeaf<float, 2, 2>& c, const PaddedLeaf<float, 2, 2>& D, float floor,
                    float target, LeafValues& lacking);

}  // namespace isowave::fitting
