// Whether two triangles certainly have no point in common other than their common corners. The answer errs to one side:
// true is proven, also against rounding; false may be a pair that comes close.
//
// Two convex sets are disjoint where an axis separates them: the normals of both, the cross products of their sides, and,
// for triangles in one plane, the normals of sides within it (Gottschalk, Lin and Manocha 1996: "OBBTree").
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "isowave/mesh.h"

namespace isowave {

namespace apart_detail {

// Products of three or four differences of lengths up to L are wrong by less than 40 units in the last place of L^3 or L^4.
constexpr double kRounding = 1e-14;

inline double largest(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

inline Vec3 unit(const Vec3& v) { return v / std::max(length(v), std::numeric_limits<double>::min()); }

struct Interval {
    double low, high;
};
inline Interval around(double a, double b, double c) { return {std::min({a, b, c}), std::max({a, b, c})}; }

}  // namespace apart_detail

// REQUIRES: finite corners.
inline bool triangleIsApart(const std::array<Vec3, 3>& t, const std::array<Vec3, 3>& u) {
    using namespace apart_detail;
    const Vec3 t1 = t[1] - t[0], t2 = t[2] - t[0], u0 = u[0] - t[0], u1 = u[1] - t[0], u2 = u[2] - t[0];
    const double size = std::max({largest(t1), largest(t2), largest(u0), largest(u1), largest(u2)});
    const auto separates = [&](const Vec3& axis, double rounding) {
        const Interval a = around(0, dot(axis, t1), dot(axis, t2));
        const Interval b = around(dot(axis, u0), dot(axis, u1), dot(axis, u2));
        return b.low - a.high > rounding || a.low - b.high > rounding;
    };
    const double cubic = kRounding * size * size * size, quartic = cubic * size;
    const Vec3 nt = cross(t1, t2), nu = cross(u1 - u0, u2 - u0);
    if (separates(nt, cubic) || separates(nu, cubic)) return true;
    const std::array<Vec3, 3> sidesT{t1, t2, t2 - t1}, sidesU{u1 - u0, u2 - u0, u2 - u1};
    for (const Vec3& side : sidesT)
        if (separates(cross(nt, side), quartic)) return true;
    for (const Vec3& side : sidesU)
        if (separates(cross(nu, side), quartic)) return true;
    for (const Vec3& s : sidesT)
        for (const Vec3& r : sidesU)
            if (separates(cross(s, r), cubic)) return true;
    return false;
}

// Triangles (o, o + t1, o + t2) and (o, o + u1, o + u2). They meet elsewhere exactly if the cones that they span at o do, so
// planes through o are looked for that have one cone on one side, and the other one strictly on the other.
inline bool triangleIsApartAtCorner(const Vec3& t1, const Vec3& t2, const Vec3& u1, const Vec3& u2) {
    using namespace apart_detail;
    const double size = std::max({largest(t1), largest(t2), largest(u1), largest(u2)});
    const double cubic = kRounding * size * size * size, quartic = cubic * size;
    const Vec3 nt = cross(t1, t2), nu = cross(u1, u2);
    // Both of one cone strictly on one side.
    const auto beside = [&](const Vec3& axis, const Vec3& a, const Vec3& b, double rounding) {
        const double x = dot(axis, a), y = dot(axis, b);
        return (x > rounding && y > rounding) || (x < -rounding && y < -rounding);
    };
    if (beside(nt, u1, u2, cubic) || beside(nu, t1, t2, cubic)) return true;
    // The plane holds one ray; `across` is the other ray of its cone, `a` and `b` those of the other cone.
    const auto parts = [&](const Vec3& axis, const Vec3& across, const Vec3& a, const Vec3& b) {
        const double side = dot(axis, across), x = dot(axis, a), y = dot(axis, b);
        return (side > quartic && x < -quartic && y < -quartic) ||
               (side < -quartic && x > quartic && y > quartic);
    };
    if (parts(cross(nt, t1), t2, u1, u2) || parts(cross(nt, t2), t1, u1, u2) ||
        parts(cross(nu, u1), u2, t1, t2) || parts(cross(nu, u2), u1, t1, t2))
        return true;
    // The plane holds a ray of each.
    const auto between = [&](const Vec3& t, const Vec3& otherT, const Vec3& u, const Vec3& otherU) {
        const Vec3 axis = cross(t, u);
        const double x = dot(axis, otherT), y = dot(axis, otherU);
        return (x > cubic && y < -cubic) || (x < -cubic && y > cubic);
    };
    if (between(t1, t2, u1, u2) || between(t1, t2, u2, u1) || between(t2, t1, u1, u2) ||
        between(t2, t1, u2, u1))
        return true;
    // In one plane, with rays that go on as those of the other cone, as in every flat lattice.
    const Vec3 middleT = unit(t1) + unit(t2), middleU = unit(u1) + unit(u2);
    const double linear = kRounding * size;
    for (const Vec3& axis : {middleT, middleU, middleT - middleU}) {
        const double a = dot(axis, t1), b = dot(axis, t2), x = dot(axis, u1), y = dot(axis, u2);
        if ((a > linear && b > linear && x < -linear && y < -linear) ||
            (a < -linear && b < -linear && x > linear && y > linear))
            return true;
    }
    return false;
}

// Triangles over one edge, seen from the same side, with these normals (of any length): not folded onto each other to kFold,
// the cosine of 172 degrees.
inline bool triangleIsUnfolded(const Vec3& n, const Vec3& m) {
    constexpr double kFold = -0.99;
    const double cosine = dot(n, m);
    return cosine > 0 || cosine * cosine < kFold * kFold * dot(n, n) * dot(m, m);
}

}  // namespace isowave
