// The point of a triangle nearest to another point. Internal to isowave_measure.
#pragma once

#include <algorithm>

namespace isowave {

template <class Kernel>
typename Kernel::Point_3 nearestOnSegment(const typename Kernel::Point_3& q,
                                          const typename Kernel::Point_3& a,
                                          const typename Kernel::Point_3& b) {
    const typename Kernel::Vector_3 along = b - a;
    const double length2 = along.squared_length();
    if (length2 == 0) return a;
    return a + std::clamp((q - a) * along / length2, 0.0, 1.0) * along;
}

// Inside the prism over the triangle the nearest point is the foot on its plane, else it lies on a side.
// CGAL's own projection divides by the length of the normal and returns NaN for a triangle without area;
// sliver triangles are what CAD meshes are full of, so that case has to work.
template <class Kernel>
typename Kernel::Point_3 nearestOnTriangle(const typename Kernel::Point_3& q,
                                           const typename Kernel::Point_3& a,
                                           const typename Kernel::Point_3& b,
                                           const typename Kernel::Point_3& c) {
    using Point3 = typename Kernel::Point_3;
    const typename Kernel::Vector_3 normal = CGAL::cross_product(b - a, c - a);
    const double normal2 = normal.squared_length();
    const auto insideOf = [&](const Point3& u, const Point3& v) {
        return CGAL::cross_product(v - u, q - u) * normal >= 0;
    };
    if (normal2 > 0 && insideOf(a, b) && insideOf(b, c) && insideOf(c, a))
        return q - ((q - a) * normal / normal2) * normal;
    Point3 best = nearestOnSegment<Kernel>(q, a, b);
    for (const Point3& p : {nearestOnSegment<Kernel>(q, b, c), nearestOnSegment<Kernel>(q, c, a)})
        if ((q - p).squared_length() < (q - best).squared_length()) best = p;
    return best;
}

}  // namespace isowave
