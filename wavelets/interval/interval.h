// The interval algebra: cubic B-spline wavelets on a cut-off domain, one interval of known control points at
// a time. It knows no grid: curves2d/ and the directions of the 3D transform (wavelets/direction.h) both use
// it.
//
// Notation (E = Esteve, Brunet, Vinacua: Multiresolution for algebraic curves and surfaces using wavelets):
//   f  fine control points x_0 .. x_{2n+2}, at lattice positions first .. last, both odd
//   c  coarse control points, n+3 of them; coarse control point j lies at fine position 2j, so an interval
//      [first, last] has coarse positions (first-1)/2 .. (last+1)/2
//   d  details, n of them; detail k is filed at coarse position (first-1)/2 + 1 + k
//   f = P c + Q d, P with columns (1,4,6,4,1)/8 cut off at the ends, Q spanning the L2-orthogonal complement.
//
// What one interval goes through (E§4.2, E§4.3):
//   extend   four accessory points of one value beyond either end: n+4 coarse intervals
//   analyse  (P|Q)^-1 of the extended interval
//   reject   two coarse control points and two details at either end
//   recover  (synthesis) the 8 rejected coefficients from the 8 accessory values, which are known: E(17)
//
// Contract, with K = max |f|, |left|, |right|:
//   (1) PᵀIQ = 0: details are L2-orthogonal to every coarse function of the extended domain.
//   (2) synthesise(analyse(f)) differs from f by at most kRoundTrip * K.
//   (3) one known value everywhere (f = left = right) gives c of that value and d = 0, up to rounding.
//   (4) mirroring f mirrors c and d.
#pragma once

#include <span>
#include <vector>

#include "wavelets/interval/runs.h"

namespace isowave::wavelets {

// Largest error of a round trip of one interval in double, relative to K;
// tests/wavelets/interval/interval_test.cpp has what is seen.
inline constexpr double kRoundTrip = 1e-13;

// Analysis and synthesis of one interval. Holds scratch memory: one object a thread; no call allocates once
// the longest interval has been seen. Results do not depend on the history of calls.
class IntervalTransform {
  public:
    IntervalTransform();

    // fine: 2n+3 values, accessory ones filled in; left, right: the value of the four accessory points beyond
    // either end. Writes n+3 values to coarse and n to detail.
    // REQUIRES: n >= 1; coarse and detail do not overlap fine.
    void analyse(std::span<const double> fine, double left, double right, std::span<double> coarse,
                 std::span<double> detail);

    // The inverse. Writes 2n+3 values to fine.
    void synthesise(std::span<const double> coarse, std::span<const double> detail, double left, double right,
                    std::span<double> fine);

  private:
    double* row0(int n);  // rows of kernels.h, all 0
    double* folded(int n) {
        return scratch_.data() + (scratch_.size() - static_cast<std::size_t>(2 * n + 5));
    }

    std::vector<double> scratch_;
};

}  // namespace isowave::wavelets
