// Limit positions of curves: where subdivision without end takes each control point.
//
//   closed       the limit mask of the scheme (limit_mask.h): cubic (1, 4, 1)/6, chaikin (1, 6, 1)/8
//   open         B-splines: the curve at the mean of the point's inner knots, g_i = (t[i+1] + .. + t[i+degree])/degree
//                (Greville's abscissa), which inside is that mask; the ends stay
//   dlg          the points themselves: the four-point rule goes through them
#pragma once

#include "isowave/subdivision.h"
#include "subdivision/curves/curve_schemes.h"

namespace isowave::subdivision {

class CurveLimit {
  public:
    // Throws InputError as limitMask() does: a mask of one's own may have no limit.
    explicit CurveLimit(const CurveScheme& scheme);

    // The curve has enough points for the scheme's basis functions. A closed one always has.
    bool takes(const Polyline& curve) const;
    // The same points at their limits. Throws InputError unless takes(curve), and for an open curve and a mask of one's
    // own, which says nothing about ends.
    Polyline of(const Polyline& curve) const;

  private:
    Polyline closed(const Polyline& curve) const;
    Polyline open(const Polyline& curve) const;

    CurveScheme scheme_;
    bool keepsPoints_;
    FilterRow mask_;  // about the control point
};

}  // namespace isowave::subdivision
