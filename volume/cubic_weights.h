// The cubic B-spline's weights of the four control points around a place on an axis.
#pragma once

#include <array>

namespace isowave {

// B on its four unit pieces, at t of the way from the second control point to the third (0 <= t <= 1):
// (1-t)^3/6, (3t^3-6t^2+4)/6, (-3t^3+3t^2+3t+1)/6, t^3/6.
inline std::array<double, 4> cubicWeights(double t) {
    const double u = 1 - t;
    return {u * u * u / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (-3 * t * t * t + 3 * t * t + 3 * t + 1) / 6,
            t * t * t / 6};
}

}  // namespace isowave
