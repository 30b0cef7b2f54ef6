// The point of a triangle nearest to another point. Internal to isowave_measure.
#pragma once

#include <algorithm>
#include <limits>

namespace isowave {

template <class Kernel>
inline typename Kernel::Point_3 nearestOnSegment(const typename Kernel::Point_3& q,
                                                 const typename Kernel::Point_3& a,
                                                 const typename Kernel::Point_3& b) {
    const typename Kernel::Vector_3 along = b - a;
    const double length2 = along.squared_length();
    if (length2 == 0) return a;
    return a + std::clamp((q - a) * along / length2, 0.0, 1.0) * along;
}

// Inside the prism over the triangle the nearest point is the foot on its plane; else it lies on a side that q can see, one
// with q beyond it: at the nearest point x the vector q - x has a positive part along the outward normal of a side that x is
// on. CGAL's own projection divides by the length of the normal and returns NaN for a triangle without area; sliver
// triangles are what CAD meshes are full of, so that case has to work: where the normal is noise, all sides are asked.
template <class Kernel>
inline typename Kernel::Point_3 nearestOnTriangle(const typename Kernel::Point_3& q,
                                                  const typename Kernel::Point_3& a,
                                                  const typename Kernel::Point_3& b,
                                                  const typename Kernel::Point_3& c) {
    using Point3 = typename Kernel::Point_3;
    using Vector3 = typename Kernel::Vector_3;
    const Vector3 ab = b - a, bc = c - b, ca = a - c;
    const Vector3 normal = CGAL::cross_product(ab, bc);
    const double normal2 = normal.squared_length();
    // |normal| is the height times the longest side: heights below 1e-7 of that side are noise.
    constexpr double kNoise = 1e-14;
    const double longest2 = std::max({ab.squared_length(), bc.squared_length(), ca.squared_length()});
    const bool flat = !(normal2 > kNoise * longest2 * longest2);
    const bool beyondAb = flat || CGAL::cross_product(ab, q - a) * normal < 0;
    const bool beyondBc = flat || CGAL::cross_product(bc, q - b) * normal < 0;
    const bool beyondCa = flat || CGAL::cross_product(ca, q - c) * normal < 0;
    if (!beyondAb && !beyondBc && !beyondCa) return q - ((q - a) * normal / normal2) * normal;
    Point3 best = a;
    double least = std::numeric_limits<double>::infinity();
    const auto take = [&](const Point3& p) {
        const double d = (q - p).squared_length();
        if (!(d < least)) return;
        least = d;
        best = p;
    };
    if (beyondAb) take(nearestOnSegment<Kernel>(q, a, b));
    if (beyondBc) take(nearestOnSegment<Kernel>(q, b, c));
    if (beyondCa) take(nearestOnSegment<Kernel>(q, c, a));
    return best;
}

}  // namespace isowave
