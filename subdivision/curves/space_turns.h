// How a curve in space turns from one shape to another, point by point: what its details turn by in local frames.
//
//   a_i, b_i   the points before and after
//   R_i        the rotation with the least sum of w_k |R (a_k - a_i) - (b_k - b_i)|^2 over the neighbours k = i - 2 .. i + 2, and, with
//              a thousandth of their weight, of the same about the mean for all points
//
// (Kabsch 1976: the rotation of the singular value decomposition of the sum of w_k (a_k - a_i)(b_k - b_i)^T.) A tangent alone does not
// say how to turn about it. The neighbours do where the curve bends; where it is straight, the whole does. Where all of the curve is
// straight, R_i is the least rotation from tangent to tangent.
//
// (1) A rigid motion b = R a + c has R_i = R everywhere, unless the curve is straight.
//
// Frenet's frames jump where a curve bends the other way, and frames without twist (Wang et al. 2008: double reflection) carry what an
// edit does at one end to the other.
#pragma once

#include <array>
#include <vector>

#include "isowave/mesh.h"

namespace isowave::subdivision {

class SpaceTurns {
  public:
    // REQUIRES: curves in space of one size, closed both or neither.
    SpaceTurns(const Polyline& before, const Polyline& after);

    Vec3 turned(std::size_t point, const Vec3& displacement) const;

  private:
    std::vector<std::array<Vec3, 3>> rows_;  // of R_i
};

}  // namespace isowave::subdivision
