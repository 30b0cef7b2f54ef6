// The mean square distance from planes as a function of a point: what an edge collapse should keep low.
// Garland and Heckbert 1997: "Surface simplification using quadric error metrics". The planes are uncertain, with normals of
// standard deviation kSpread (Trettner and Kobbelt 2020: "Fast and robust QEM minimization using probabilistic quadrics"):
// this adds kSpread^2 |x - v|^2, so that every quadric has one minimum, also on a plane, where it keeps the vertices evenly spread.
#pragma once

#include <algorithm>
#include <cmath>

#include "isowave/mesh.h"

namespace isowave {

// Q(x) = x'Ax - 2 b'x + c for points x relative to the quadric's own centre: small numbers near the surface, wherever the
// mesh lies. World units^4: squared distances times areas.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;  // A
    Vec3 b;
    double c = 0;
    // Of the spread's part, kSpread^2 (w x'x - 2 m'x + s): the first and second moment of the planes' points.
    Vec3 m;
    double s = 0;

    static constexpr double kSpread = 0.001;

    // A plane through the centre. normal: as long as twice the triangle's area; a third of it is each corner's.
    static Quadric ofCorner(const Vec3& normal) {
        const double twice = length(normal);
        if (!(twice > 0)) return {};
        const double w = 1 / (6 * twice), spread = kSpread * kSpread * twice / 6;
        const Vec3 n = w * normal;
        return {n.x * normal.x + spread,
                n.x * normal.y,
                n.x * normal.z,
                n.y * normal.y + spread,
                n.y * normal.z,
                n.z * normal.z + spread,
                {},
                0,
                {},
                0};
    }
    // The sum of the planes' weights: each normal counts 1 in the trace of A, its spread 3 kSpread^2.
    double weight() const { return (xx + yy + zz) / (1 + 3 * kSpread * kSpread); }
    // The mean square distance of x from the planes alone, without their spread: 0 on a plane, as far as rounding goes.
    double meanSquareAt(const Vec3& x) const {
        const double w = weight();
        if (!(w > 0)) return 0;
        const double spread = kSpread * kSpread * (w * dot(x, x) - 2 * dot(m, x) + s);
        return std::max(0.0, at(x) - spread) / w;
    }
    Vec3 times(const Vec3& x) const {
        return {xx * x.x + xy * x.y + xz * x.z, xy * x.x + yy * x.y + yz * x.z,
                xz * x.x + yz * x.y + zz * x.z};
    }
    double at(const Vec3& x) const { return dot(x, times(x)) - 2 * dot(b, x) + c; }
    // The same function about the centre + by: Q(y + by) = y'Ay - 2 (b - A by)'y + Q(by).
    Quadric about(const Vec3& by) const {
        Quadric q = *this;
        const double w = weight();
        q.b = b - times(by);
        q.c = at(by);
        q.m = m - w * by;
        q.s = s - 2 * dot(m, by) + w * dot(by, by);
        return q;
    }
    Quadric& operator+=(const Quadric& q) {
        xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
        b += q.b, c += q.c;
        m += q.m, s += q.s;
        return *this;
    }
};

// The inverse of A times vectors, by cofactors: kSpread bounds the condition by 1/kSpread^2.
class QuadricSolver {
  public:
    explicit QuadricSolver(const Quadric& q)
        : xx_(q.yy * q.zz - q.yz * q.yz),
          xy_(q.xz * q.yz - q.xy * q.zz),
          xz_(q.xy * q.yz - q.xz * q.yy),
          yy_(q.xx * q.zz - q.xz * q.xz),
          yz_(q.xy * q.xz - q.xx * q.yz),
          zz_(q.xx * q.yy - q.xy * q.xy) {
        const double determinant = q.xx * xx_ + q.xy * xy_ + q.xz * xz_;
        scale_ = determinant > 0 ? 1 / determinant : 0;
    }
    // False where the planes have no area: solve() gives no use then.
    bool solvable() const { return scale_ > 0 && std::isfinite(scale_); }
    Vec3 solve(const Vec3& b) const {
        return scale_ * Vec3{xx_ * b.x + xy_ * b.y + xz_ * b.z, xy_ * b.x + yy_ * b.y + yz_ * b.z,
                             xz_ * b.x + yz_ * b.y + zz_ * b.z};
    }

  private:
    double xx_, xy_, xz_, yy_, yz_, zz_, scale_;
};

}  // namespace isowave
