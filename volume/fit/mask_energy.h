// How far values on a lattice are from a plane's: the energy that a fit to a mask makes least.
//
//   E(v) = sum over axes a, points i:        (v(i+a) - 2 v(i) + v(i-a))^2 / 2
//        + sum over pairs of axes a < b, i:  (v(i) - v(i+a) - v(i+b) + v(i+a+b))^2
//
// the integral of the squared Hessian's entries / 2. A difference that touches a point without a value (not a number)
// is left out: the band's border is free. Where all have one, the gradient is 42 v - 12 (six face neighbours) + (six at
// distance 2) + 2 (twelve edge neighbours); its largest eigenvalue is 16 * 3 + 2 * 16 * 3 = 144, at v = (-1)^(x+y+z).
#pragma once

#include <limits>

#include "volume/fit/mask_band.h"

namespace isowave::fitting {

inline constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kLargestEigenvalue = 144;

// dE/dv at a leaf's lattice points; a number also where the point itself has no value.
void gradientOfEnergy(const PaddedLeaf<float, 2, 2>& v, LeafValues& gradient);

}  // namespace isowave::fitting
