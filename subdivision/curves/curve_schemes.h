// The curve subdivisions that come with isowave, and their filters in doubles.
// Bartels and Samavati (B): sections 4, 5. Olsen and Samavati, "A discrete approach to multiresolution curves
// and surfaces" (O): section 5.
//
//   scheme         fine points: closed   open               A
//   chaikin-W      2n                    2n - 2, n >= 3     least norm of W taps (W = 4, 8, 12, ..)
//   cubic-W        2n                    2n - 3, n >= 4     least norm of W taps (W = 3, 7, 11, ..)
//   dlg-trial      2n                    2n - 1, n >= 2     keeps every second point
//   dlg-refined    2n                    2n - 1, n >= 2     O(3): moves a kept point to lessen the details beside it
//   dlg-optimal    2n                    2n - 1, n >= 2     least norm of 9 taps
//
// Open ends. chaikin and cubic are the B-splines whose first and last knot are repeated (3-fold, 4-fold), so the curve
// begins at its first point; dlg is the four-point rule (four_point.h). A row of A near an end has the window of the
// interior, narrowed about its vertex node until it fits (B section 5).
//
// Virtual points. A size that the subdivision does not make (an odd number of closed points, say) is brought to one that
// it does by one more point, placed where one detail vanishes. That detail is not stored, and reconstruction drops the
// point again, so as many numbers are stored as there were. For the closed cubic the point is
// (4(f[-1] + f[1]) - f[-2] - f[2])/6. Closed curves take it at the last detail, open ones two details beside the middle:
//   at the end      Chaikin's ends do not bear it. There f[0] = c[0], f[1] = (c[0] + c[1])/2, so a vanishing detail says
//                   c[1] = 2 f[1] - f[0], and a size that asks for a virtual point at every level (2^k + 3) doubles
//                   what stands beside the end with every level.
//   in the middle   Halving leaves the middle where it is, so each virtual point would be made of the one before (a
//                   factor of 1.35 a level for chaikin-4).
//   two beside it   the virtual points of two levels do not meet, and nothing grows.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/subdivision.h"
#include "subdivision/filters/construct.h"
#include "subdivision/filters/finite_subdivision.h"
#include "subdivision/filters/four_point.h"

namespace isowave::subdivision {

struct CurveScheme {
    enum class Family { BSpline, DynLevinGregory, OwnMask };
    enum class Fit { LeastNorm, Refined };
    std::string name;
    Family family = Family::BSpline;
    Fit fit = Fit::LeastNorm;
    Mask mask;
    int degree = 3;  // of a B-spline
    int width = 7;   // taps of A inside the curve
};

// "dlg-refined", "cubic-7", "chaikin-4"; "cubic" is cubic-7, "chaikin" chaikin-4, "dlg" dlg-refined.
// Throws InputError that lists the schemes.
CurveScheme curveScheme(std::string_view name);
// Closed curves only.
CurveScheme ownScheme(const Mask& mask, int width);
// The same for taps as text; width 0: the smallest there is. Throws as construct() does.
CurveScheme maskScheme(std::string_view taps, int width);

// Inside a curve: A, B, Q of the scheme. Throws as construct() does.
Filters interiorFilters(const CurveScheme& scheme);

// All diagrams of an open curve with n coarse points (nodes (0,0) .. (n-1,0)), proved.
// Throws InputError when n is too small, or the scheme is for closed curves only.
struct OpenSystem {
    FiniteSubdivision p;
    System system;
    std::vector<int> detailNode;  // the fine point that a detail stands for
};
OpenSystem openSystem(const CurveScheme& scheme, int n);
// The same for a closed curve: the filters of the interior, added up where they meet around the curve.
System closedSystem(const CurveScheme& scheme, int n);

// One row: out = sum of weights[k] * in[first + k].
struct FilterRow {
    std::ptrdiff_t first = 0;
    std::vector<double> weights;
};

// A banded linear map that repeats. Outputs 0 .. head.size()-1 have rows of their own; the last tail.size()
// too, with `first` counted from the end of the input; between them, output head.size() + q has the row q mod
// period of `inner`, moved on by (q div period) * step. A closed map has neither head nor tail and wraps
// around.
struct FilterBank {
    std::vector<FilterRow> head, inner, tail;
    std::ptrdiff_t step = 1;
};

// The filters of a scheme for curves of any length, in doubles. Immutable once made: share it between threads.
class CurveFilters {
  public:
    // Derives and proves: some 10 to 300 ms for open curves.
    CurveFilters(const CurveScheme& scheme, bool closed);

    const CurveScheme& scheme() const { return scheme_; }
    bool closed() const { return closed_; }

    // Fine points made from n coarse ones; the fewest coarse points there may be.
    std::size_t fineSize(std::size_t n) const;
    std::size_t fewestCoarse() const;
    // Coarse points of a curve of m points; nothing when m cannot be halved any more.
    std::optional<std::size_t> coarseSize(std::size_t m) const;
    // The fewest points with which `levels` decompositions are possible, and the most levels of m points.
    std::size_t fewestPoints(int levels) const;
    int mostLevels(std::size_t m) const;

    // The maps of one size: n coarse, fineSize(n) fine, fineSize(n) - n details.
    struct Maps {
        FilterBank a, b, p, q;
    };
    const Maps& maps(std::size_t n) const;
    // The detail that is not stored when a size asks for a virtual point, and the fine point that stands for it:
    // where that point goes. REQUIRES: fineSize(n) > n.
    std::size_t virtualDetail(std::size_t n) const;
    std::size_t virtualPoint(std::size_t n) const;

  private:
    CurveScheme scheme_;
    bool closed_;
    Maps long_;                // for every n that is not in short_
    std::vector<Maps> short_;  // open: n = fewestCoarse() + index
};

}  // namespace isowave::subdivision
