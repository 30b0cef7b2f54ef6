// A level's control points taken from another field, with the details of finer levels.
//
//   c     control points of the level, c' those of the other field; P c, P c': the same functions on level 0's lattice (knot
//         insertion, as in lod/regions/fade.h)
//   f     control points of level 0; f = P c + d, d the details of all steps between them
//
//   f'  = P c' + w d = f + (P c' - P c) - (1 - w) d,   w = 1 - t^2 (3 - 2 t),   t = min(1, |P c' - P c| / K)
//
// So where c' = c nothing changes, to the bit; where the surface moves a little the details ride on it; and where it has gone, F having
// changed by K there, no ghost of it is left.
#pragma once

#include <array>

#include "lod/edit/change.h"

namespace isowave::lod {

// halvings: how often each axis has been halved from level 0 to the level of `before` and `after`. REQUIRES: one lattice and one K; finest: level 0 of `before`.
Change replaced(const BSplineField& finest, const BSplineField& before, const BSplineField& after,
                const std::array<int, 3>& halvings, const Progress& progress);

}  // namespace isowave::lod
