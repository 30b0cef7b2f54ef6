// Where a mesh's vertices lie: the zeros of the spline on a lattice edge, and on the ray from a cell's middle to a corner.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "polygonize/blocks.h"
#include "volume/cubic_weights.h"

namespace isowave {

// Control points in a dense array; (0, 0, 0) is one of its lattice points, not its first value.
struct DenseControlPoints {
    const float* origin;
    std::array<int, 3> stride;

    const float* at(int x, int y, int z) const {
        return origin + x * stride[0] + y * stride[1] + z * stride[2];
    }
};
inline DenseControlPoints controlPointsOf(const PaddedBlock& block) {
    return {&block.values[PaddedBlock::index(0, 0, 0)], kPaddedStride};
}

// a + bt + ct^2 + dt^3
struct Cubic {
    double a, b, c, d;

    double operator()(double t) const { return a + t * (b + t * (c + t * d)); }
    double slope(double t) const { return b + t * (2 * c + t * 3 * d); }

    // The uniform cubic B-spline with control points p at -1, 0, 1, 2, on [0, 1].
    static Cubic fromControlPoints(const std::array<double, 4>& p) {
        return {(p[0] + 4 * p[1] + p[2]) / 6, (p[2] - p[0]) / 2, (p[0] - 2 * p[1] + p[2]) / 2,
                (p[3] - p[0] + 3 * (p[1] - p[2])) / 6};
    }
};

// F and its derivatives on the two other axes, restricted to a lattice edge.
struct EdgeField {
    Cubic value, alongU, alongV;  // u = axis + 1, v = axis + 2, cyclic
    double scale;                 // the largest |control point| in reach
};

// In the two directions across the edge t is a lattice point: B there is (1,4,1)/6 and B' is (-1,0,1)/2.
inline EdgeField edgeField(const DenseControlPoints& points, const std::array<int, 3>& end, int axis) {
    const int s = points.stride[axis];
    const int u = points.stride[(axis + 1) % 3], v = points.stride[(axis + 2) % 3];
    std::array<double, 4> value, alongU, alongV;
    double scale = 0;
    for (int j = 0; j < 4; ++j) {
        const float* c = points.at(end[0], end[1], end[2]) + (j - 1) * s;
        std::array<double, 3> mean, difference;  // along u, at v - 1, v, v + 1
        for (int k = 0; k < 3; ++k) {
            const double low = c[(k - 1) * v - u], middle = c[(k - 1) * v], high = c[(k - 1) * v + u];
            mean[k] = (low + 4 * middle + high) / 6;
            difference[k] = (high - low) / 2;
            scale = std::max({scale, std::abs(low), std::abs(middle), std::abs(high)});
        }
        value[j] = (mean[0] + 4 * mean[1] + mean[2]) / 6;
        alongU[j] = (difference[0] + 4 * difference[1] + difference[2]) / 6;
        alongV[j] = (mean[2] - mean[0]) / 2;
    }
    return {Cubic::fromControlPoints(value), Cubic::fromControlPoints(alongU),
            Cubic::fromControlPoints(alongV), scale};
}

// A t in [0, 1] with a sign change of f within `tolerance`.
// invariant: f has the low end's sign at `low` and the other one at `high`, by the stored signs of the
// lattice points at 0 and 1 (rounding may have f(0) on the wrong side of zero there, by an ulp). Newton's
// step is stretched by half the tolerance: once it has converged from one side, it lands just beyond the root
// and closes the bracket from the other. A cubic can have three roots, or a tangent one that Newton creeps
// towards: after kNewton steps the bracket is halved instead, which ends surely.
inline double rootOf(const Cubic& f, bool insideAtLow, double tolerance) {
    constexpr int kNewton = 8;
    tolerance = std::max(tolerance, 1e-15);
    double low = 0, high = 1;
    const double f0 = f(0), f1 = f(1);
    double t = f0 != f1 ? std::clamp(f0 / (f0 - f1), 0.0, 1.0) : 0.5, root = t;
    for (int step = 0; high - low > tolerance && step < 80; ++step) {
        const double y = f(t);
        ((y < 0) == insideAtLow ? low : high) = t;
        const double newton = -y / f.slope(t);
        root = t + newton;
        t = root + std::copysign(tolerance / 2, newton);
        if (step >= kNewton || !(t > low && t < high)) t = (low + high) / 2;
    }
    return std::isfinite(root) ? std::clamp(root, low, high) : (low + high) / 2;
}

// F and its gradient anywhere in a cell.
struct CellField {
    double value = 0;
    openvdb::Vec3d gradient{0.0};
    double scale = 0;
};
inline CellField fieldIn(const DenseControlPoints& points, const std::array<int, 3>& cell,
                         const openvdb::Vec3d& at) {
    std::array<std::array<double, 4>, 3> w, d;
    for (int a = 0; a < 3; ++a) {
        const double t = at[a] - cell[a], u = 1 - t;
        w[a] = cubicWeights(t);
        d[a] = {-u * u / 2, (3 * t - 4) * t / 2, (4 - 3 * u) * u / 2, t * t / 2};
    }
    CellField f;
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = 0; z < 4; ++z) {
                const double c = *points.at(cell[0] + x - 1, cell[1] + y - 1, cell[2] + z - 1);
                f.value += w[0][x] * w[1][y] * w[2][z] * c;
                f.gradient += c * openvdb::Vec3d(d[0][x] * w[1][y] * w[2][z], w[0][x] * d[1][y] * w[2][z],
                                                 w[0][x] * w[1][y] * d[2][z]);
                f.scale = std::max(f.scale, std::abs(c));
            }
    return f;
}

// How far along the ray from the middle to a corner F changes sign, 0 to 1, by halving: inside or outside at the middle, the
// other at the corner.
inline double rootOnRay(const DenseControlPoints& points, const std::array<int, 3>& cell,
                        const openvdb::Vec3d& middle, const openvdb::Vec3d& corner, bool middleInside,
                        double tolerance) {
    double low = 0, high = 1;
    for (int step = 0; high - low > std::max(tolerance, 1e-15) && step < 60; ++step) {
        const double t = (low + high) / 2;
        const bool inside = fieldIn(points, cell, middle + (corner - middle) * t).value < 0;
        (inside == middleInside ? low : high) = t;
    }
    return (low + high) / 2;
}

}  // namespace isowave
