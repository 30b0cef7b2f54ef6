// The subdivisions that come by name, and those of one's own, as masks.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "subdivision/filters/construct.h"

namespace isowave::subdivision {

// Masks by name: chaikin, cubic, dlg on the line; butterfly, loop on the triangular lattice; catmull-clark
// (its regular part, the bicubic B-spline) on the quad lattice. Throws InputError that lists them.
Mask namedMask(std::string_view name);
const std::vector<std::string>& maskNames();

// Loop-like: a vertex node gets 1 - 6 alpha of its own and alpha of each neighbour, an edge node 1/2 - gamma
// of its ends and gamma of the two opposite. Loop is alpha = 1/16, gamma = 1/8. (Litke's mask is of this family; the
// text of B does not print its two numbers.)
Mask loopLike(const Rational& alpha, const Rational& gamma);

// B-spline of this degree on the line, mask binomial(degree + 1, k) / 2^degree. REQUIRES: degree >= 1.
Mask bspline(int degree);

// The user's own. On the line: the taps in order, with the middle one (or the left of the two middle ones) on
// the vertex node. Else: the values in spiral order (ring k starts at (0, k) and runs clockwise). Throws
// InputError when there is no tap, or only zeros.
Mask customMask(Lattice lattice, const std::vector<Rational>& values);

}  // namespace isowave::subdivision
