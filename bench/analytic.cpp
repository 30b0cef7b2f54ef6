#include "analytic.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace isowave::bench {
namespace {

using openvdb::Vec3d;

// The largest of the distances to the six planes.
double box(const Vec3d& p, const Vec3d& half) {
    return std::max({std::abs(p[0]) - half[0], std::abs(p[1]) - half[1], std::abs(p[2]) - half[2]});
}

double gyroid(const Vec3d& p) {
    return std::sin(p[0]) * std::cos(p[1]) + std::sin(p[1]) * std::cos(p[2]) +
           std::sin(p[2]) * std::cos(p[0]);
}

struct Wave {
    Vec3d k;
    double phase;
};

std::vector<Wave> randomWaves(double length) {
    constexpr int kWaves = 40;
    std::mt19937_64 random(20040707);
    // Not std::normal_distribution: its numbers differ from library to library.
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    std::vector<Wave> waves;
    for (int i = 0; i < kWaves; ++i) {
        const double z = 2 * uniform() - 1, angle = 2 * std::numbers::pi * uniform();
        const double k = 2 * std::numbers::pi / (length * (0.9 + 0.2 * uniform()));
        const double r = std::sqrt(1 - z * z);
        waves.push_back(
            {k * Vec3d(r * std::cos(angle), r * std::sin(angle), z), 2 * std::numbers::pi * uniform()});
    }
    return waves;
}

}  // namespace

double plate(const Vec3d& p, int n) {
    constexpr double kPitch = 32;
    const double margin = 16.0 * n;
    double d = box(p - Vec3d(0, 0, 0.13), Vec3d(margin + 4.3, margin + 4.4, 6.2));
    for (int i = 0; i < n * n; ++i)
        d = std::max(d, 1.2 + 6.8 * i / (n * n - 1) -
                            std::hypot(p[0] + 16 * (n - 1) - kPitch * (i % n),
                                       p[1] + 16 * (n - 1) - kPitch * (i / n)));
    const double between = n % 2 == 0 ? 0 : kPitch / 2;  // two rows of holes
    d = std::min(d, box(p - Vec3d(0, between, 26.3), Vec3d(11.7 * n, 1.0, 20.0)));
    const int balls = 2 * n;
    for (int i = 0; i < balls; ++i)
        d = std::min(
            d, (p - Vec3d(-8 * (balls - 1) + 16 * i, 40.3, 20.4)).length() - (1 + 3.0 * i / (balls - 1)));
    return d;
}

AnalyticSolid plateSolid(int n) {
    // Lattice planes must not lie on the plate's.
    return {[n](const Vec3d& p) { return plate(p - Vec3d(0.11, 0.23, 0.31), n); }, 1, 16.0 * n + 48};
}

AnalyticSolid gyroidBlock(double period, double half) {
    const double k = 2 * std::numbers::pi / period;
    // |grad| of the sum is at most 1.5 (seen), so with slope 1 in the middle, where it is 1 to 1.5.
    return {[k, half](const Vec3d& p) { return std::max(gyroid(k * p) / k, box(p, Vec3d(half))); }, 2, half};
}

AnalyticSolid trabecularBall(double wave, double radius) {
    const std::vector<Wave> waves = randomWaves(wave);
    // A sum of n waves has the standard deviation sqrt(n/2); a third of the space is above 0.43 of it.
    const double deviation = std::sqrt(static_cast<double>(waves.size()) / 2);
    const double scale = wave / (2 * std::numbers::pi) / deviation;  // rms slope about 1
    const auto value = [waves, radius, scale, limit = 0.43 * deviation](const Vec3d& p) {
        const double ball = p.length() - radius;
        if (ball > 4) return ball;
        double sum = 0;
        for (const Wave& w : waves) sum += std::cos(w.k.dot(p) + w.phase);
        return std::max(scale * (limit - sum), ball);
    };
    // Five standard deviations of the slope.
    return {value, 5, radius};
}

AnalyticSolid turned(const AnalyticSolid& solid) {
    openvdb::Mat3d m;
    m.setToRotation(Vec3d(1, 2, 3).unit(), 0.7);
    return {[value = solid.value, m](const Vec3d& p) { return value(p * m); }, solid.slope,
            std::sqrt(3.0) * solid.extent};
}

}  // namespace isowave::bench
