// The interval algebra: cubic B-spline wavelets on a cut-off domain, one interval of known control points at
// a time. No grid in here; curves2d/ and the 3D direction both stand on it.
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

#include <cstdint>
#include <span>
#include <vector>

namespace isowave::wavelets {

// Largest error of a round trip of one interval in double, relative to K. Seen: see
// tests/wavelets/interval_test.
inline constexpr double kRoundTrip = 1e-13;

// Accessory points added beyond either end of an interval; coefficients of each kind rejected at either end.
inline constexpr int kAccessory = 4;
inline constexpr int kRejected = 2;

// Two intervals whose odd ends are at most this far apart become one.
inline constexpr int kJoin = 4;

// A maximal run of known positions, [first, last].
struct Run {
    std::int64_t first, last;
    friend bool operator==(const Run&, const Run&) = default;
};

// An odd-ended interval of fine positions, [first, last]; holds one run or several joined ones.
struct Interval {
    std::int64_t first, last;

    std::int64_t coarseIntervals() const { return (last - first - 2) / 2; }  // n
    std::int64_t fineSize() const { return last - first + 1; }               // 2n + 3
    std::int64_t coarseSize() const { return coarseIntervals() + 3; }
    std::int64_t detailSize() const { return coarseIntervals(); }
    std::int64_t firstCoarse() const { return (first - 1) / 2; }  // exact: first is odd
    std::int64_t lastCoarse() const { return (last + 1) / 2; }
    std::int64_t firstDetail() const { return firstCoarse() + 1; }
    friend bool operator==(const Interval&, const Interval&) = default;
};

// Runs (ascending, separated by at least one unknown position, each of length >= 4) -> intervals: ends moved
// outwards to odd positions, neighbours whose ends are <= kJoin apart joined. Replaces the content of `out`.
void joinRuns(std::span<const Run> runs, std::vector<Interval>& out);

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
    double* row0(int n);  // rows of interval_kernels.h, all 0
    double* folded(int n) {
        return scratch_.data() + (scratch_.size() - static_cast<std::size_t>(2 * n + 5));
    }

    std::vector<double> scratch_;
};

}  // namespace isowave::wavelets
