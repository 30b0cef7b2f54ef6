#include "subdivision/curves/curve_limit.h"

#include <algorithm>
#include <cstddef>

#include "isowave/error.h"
#include "subdivision/filters/limit_mask.h"

namespace isowave::subdivision {
namespace {

using Family = CurveScheme::Family;

// The knots 0 .. n - degree, the first and the last repeated degree + 1 times.
class ClampedKnots {
  public:
    ClampedKnots(int degree, std::ptrdiff_t n) : degree_(degree), last_(n - degree) {}
    double operator[](std::ptrdiff_t k) const {
        return static_cast<double>(std::clamp<std::ptrdiff_t>(k - degree_, 0, last_));
    }
    double greville(std::ptrdiff_t i) const {
        double sum = 0;
        for (int r = 1; r <= degree_; ++r) sum += (*this)[i + r];
        return sum / degree_;
    }
    // The j with t[j] <= u < t[j+1]; at the end of the curve the last that is not empty.
    std::ptrdiff_t span(double u) const {
        return degree_ + std::min(static_cast<std::ptrdiff_t>(u), last_ - 1);
    }

  private:
    int degree_;
    std::ptrdiff_t last_;
};

// The basis functions that are not 0 at u, by the recursion of Cox and de Boor:
//   N_i,r = (u - t[i])/(t[i+r] - t[i]) N_i,r-1 + (t[i+r+1] - u)/(t[i+r+1] - t[i+1]) N_i+1,r-1.
FilterRow basisAt(const ClampedKnots& t, int degree, double u) {
    const std::ptrdiff_t j = t.span(u);
    FilterRow row{j - degree, std::vector<double>(static_cast<std::size_t>(degree) + 1, 0.0)};
    std::vector<double>& n = row.weights;
    n[0] = 1;
    for (int r = 1; r <= degree; ++r) {
        double carried = 0;
        for (int s = 0; s < r; ++s) {
            const double left = t[j + 1 - r + s], right = t[j + 1 + s];
            double& each = n[static_cast<std::size_t>(s)];
            const double part = each / (right - left);
            each = carried + (right - u) * part;
            carried = (u - left) * part;
        }
        n[static_cast<std::size_t>(r)] = carried;
    }
    return row;
}

// sum of row.weights[k] * points[place(row.first + k)], for points of `dimension` numbers.
template <class Place>
void addRow(const FilterRow& row, const Polyline& curve, Place place, double* sum) {
    const auto d = static_cast<std::size_t>(curve.dimension);
    for (std::size_t k = 0; k < row.weights.size(); ++k) {
        const double* point =
            curve.coordinates.data() + place(row.first + static_cast<std::ptrdiff_t>(k)) * d;
        for (std::size_t c = 0; c < d; ++c) sum[c] += row.weights[k] * point[c];
    }
}

FilterRow rowOf(const Diagram& mask) {
    const Extent box = extent(mask);
    FilterRow row{box.low.x, {}};
    for (int x = box.low.x; x <= box.high.x; ++x) row.weights.push_back(toDouble(mask[{x, 0}]));
    return row;
}

}  // namespace

CurveLimit::CurveLimit(const CurveScheme& scheme)
    : scheme_(scheme), keepsPoints_(scheme.family == Family::DynLevinGregory) {
    if (!keepsPoints_) mask_ = rowOf(limitMask(scheme.mask));
}

bool CurveLimit::takes(const Polyline& curve) const {
    if (curve.closed || keepsPoints_) return true;
    return curve.size() > static_cast<std::size_t>(scheme_.degree);
}

Polyline CurveLimit::of(const Polyline& curve) const {
    if (keepsPoints_) return curve;
    if (curve.closed) return closed(curve);
    if (scheme_.family == Family::OwnMask)
        throw InputError("scheme '" + scheme_.name + "'",
                         "is for closed curves: a mask does not say what happens at an end; take a named "
                         "scheme");
    if (!takes(curve))
        throw InputError("curve", "has " + std::to_string(curve.size()) +
                                      " points; limit positions of an open " + scheme_.name + " curve need " +
                                      std::to_string(scheme_.degree + 1));
    return open(curve);
}

Polyline CurveLimit::closed(const Polyline& curve) const {
    const auto n = static_cast<std::ptrdiff_t>(curve.size());
    Polyline limit{curve.dimension, true, std::vector<double>(curve.coordinates.size(), 0.0)};
    FilterRow row = mask_;
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        row.first = mask_.first + i;
        addRow(
            row, curve, [n](std::ptrdiff_t k) { return static_cast<std::size_t>(((k % n) + n) % n); },
            limit.coordinates.data() + i * curve.dimension);
    }
    return limit;
}

Polyline CurveLimit::open(const Polyline& curve) const {
    const auto n = static_cast<std::ptrdiff_t>(curve.size());
    const ClampedKnots knots(scheme_.degree, n);
    Polyline limit{curve.dimension, false, std::vector<double>(curve.coordinates.size(), 0.0)};
    for (std::ptrdiff_t i = 0; i < n; ++i)
        addRow(
            basisAt(knots, scheme_.degree, knots.greville(i)), curve,
            [](std::ptrdiff_t k) { return static_cast<std::size_t>(k); },
            limit.coordinates.data() + i * curve.dimension);
    return limit;
}

}  // namespace isowave::subdivision
