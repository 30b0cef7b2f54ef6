// The point of a triangle nearest to another point.
#pragma once

#include <algorithm>
#include <limits>

#include "isowave/mesh.h"

namespace isowave {

inline double squaredLength(const Vec3& v) { return dot(v, v); }

inline Vec3 nearestOnSegment(const Vec3& q, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    const double length2 = squaredLength(along);
    if (length2 == 0) return a;
    return a + std::clamp(dot(q - a, along) / length2, 0.0, 1.0) * along;
}

// Inside the prism over the triangle the nearest point is the foot on its plane; else it lies on a side that q can see, one
// with q beyond it: at the nearest point x the vector q - x has a positive part along the outward normal of a side that x
// is on. Projecting on the plane divides by the length of the normal, which is NaN for a triangle without area, and CAD
// meshes are full of slivers: where the normal is noise, all sides are asked. (CGAL's own projection returns the NaN.)
inline Vec3 nearestOnTriangle(const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, bc = c - b, ca = a - c;
    const Vec3 normal = cross(ab, bc);
    const double normal2 = squaredLength(normal);
    // |normal| is the height times the longest side: heights below 1e-7 of that side are noise.
    constexpr double kNoise = 1e-14;
    const double longest2 = std::max({squaredLength(ab), squaredLength(bc), squaredLength(ca)});
    const bool flat = !(normal2 > kNoise * longest2 * longest2);
    const bool beyondAb = flat || dot(cross(ab, q - a), normal) < 0;
    const bool beyondBc = flat || dot(cross(bc, q - b), normal) < 0;
    const bool beyondCa = flat || dot(cross(ca, q - c), normal) < 0;
    if (!beyondAb && !beyondBc && !beyondCa) return q - (dot(q - a, normal) / normal2) * normal;
    Vec3 best = a;
    double least = std::numeric_limits<double>::infinity();
    const auto take = [&](const Vec3& p) {
        const double d = squaredLength(q - p);
        if (!(d < least)) return;
        least = d;
        best = p;
    };
    if (beyondAb) take(nearestOnSegment(q, a, b));
    if (beyondBc) take(nearestOnSegment(q, b, c));
    if (beyondCa) take(nearestOnSegment(q, c, a));
    return best;
}

}  // namespace isowave
