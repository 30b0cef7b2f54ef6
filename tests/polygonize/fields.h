// Fields made by formula, for the tests of polygonize: no fit is needed to have one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/Prune.h>

#include "volume/field.h"

namespace isowave::testing {

using openvdb::Coord;
using openvdb::Vec3d;

inline openvdb::math::Transform::Ptr oblique() {
    auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    transform->preScale(Vec3d(1, 1.5, 0.8));
    transform->postRotate(0.4, openvdb::math::Y_AXIS);
    transform->postTranslate(Vec3d(100, -20, 3));
    return transform;
}

// Control points c(x, y, z) on the box low .. high, +K elsewhere. Those other than ±K, and all within 3 of
// one, are active.
template <class ControlPoint>
BSplineField fieldFromControlPoints(const Coord& low, const Coord& high, double K, const ControlPoint& c,
                                    const openvdb::math::Transform::Ptr& transform = nullptr) {
    BSplineField field;
    field.K = K;
    field.controlPoints = openvdb::FloatGrid::create(static_cast<float>(K));
    field.shape = Shape::create(false);
    auto accessor = field.controlPoints->getAccessor();
    for (int x = low[0]; x <= high[0]; ++x)
        for (int y = low[1]; y <= high[1]; ++y)
            for (int z = low[2]; z <= high[2]; ++z) {
                const float value = static_cast<float>(c(x, y, z)), k = static_cast<float>(K);
                if (std::abs(value) != k)
                    accessor.setValueOn({x, y, z}, value);
                else if (value < 0)
                    accessor.setValueOff({x, y, z}, value);
            }
    openvdb::tools::dilateActiveValues(field.controlPoints->tree(), 3, openvdb::tools::NN_FACE_EDGE_VERTEX);
    openvdb::tools::pruneInactive(field.controlPoints->tree());
    if (transform)
        for (openvdb::GridBase::Ptr grid :
             {openvdb::GridBase::Ptr(field.controlPoints), openvdb::GridBase::Ptr(field.shape)})
            grid->setTransform(transform->copy());
    return field;
}

// Signed distance of a solid, clamped to K = 4 and quasi-interpolated: c = v - (sum of the three second
// differences of v) / 6 makes F agree with v to fourth order.
template <class Distance>
BSplineField fieldFromDistance(int reach, const Distance& distance,
                               const openvdb::math::Transform::Ptr& transform = nullptr) {
    constexpr double K = 4;
    const auto v = [&](int x, int y, int z) { return std::clamp<double>(distance(Vec3d(x, y, z)), -K, K); };
    const auto c = [&](int x, int y, int z) {
        return 2 * v(x, y, z) - (v(x - 1, y, z) + v(x + 1, y, z) + v(x, y - 1, z) + v(x, y + 1, z) +
                                 v(x, y, z - 1) + v(x, y, z + 1)) /
                                    6;
    };
    return fieldFromControlPoints(Coord(-reach), Coord(reach), K, c, transform);
}

inline auto sphere(double radius, const Vec3d& centre = Vec3d(0.31, -0.17, 0.23)) {
    return [=](const Vec3d& x) { return (x - centre).length() - radius; };
}

// A ring about a tilted axis through the origin.
inline auto torus(double ring, double tube) {
    return [=](const Vec3d& x) {
        static const Vec3d axis = Vec3d(0.3, 0.5, 0.8).unit();
        const double height = x.dot(axis), across = (x - axis * height).length() - ring;
        return std::sqrt(across * across + height * height) - tube;
    };
}

// The hardest field there is: independent ±1 control points in a cube of n^3.
inline BSplineField noiseField(int n, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<float> values(static_cast<std::size_t>(n) * n * n);
    for (float& v : values) v = static_cast<float>(random() % 2048) / 1024 - 0.9995f;
    return fieldFromControlPoints({0, 0, 0}, Coord(n - 1), 1.0, [&](int x, int y, int z) {
        return values[(static_cast<std::size_t>(x) * n + y) * n + z];
    });
}

// A field whose lattice values are s(x) in {-1, +1} exactly (to rounding) on the box 0 .. n - 1, and +1
// outside it. Each axis is interpolated: the inverse of (1,4,1)/6 has the impulse response sqrt(3) z^|k|, z =
// sqrt(3) - 2, which is cut off where it is below float32's resolution.
template <class Inside>
BSplineField fieldFromSigns(const Coord& size, const Inside& inside) {
    constexpr int kTail = 14;  // z^14 = 1e-8
    const double z = std::sqrt(3.0) - 2;
    const Coord n = size.offsetBy(2 * kTail);
    std::vector<double> v(static_cast<std::size_t>(n[0]) * n[1] * n[2], 0.0);  // deviations from +1
    const auto at = [&](int i, int j, int k) -> double& {
        return v[(static_cast<std::size_t>(i) * n[1] + j) * n[2] + k];
    };
    for (int i = 0; i < size[0]; ++i)
        for (int j = 0; j < size[1]; ++j)
            for (int k = 0; k < size[2]; ++k)
                if (inside(Coord(i, j, k))) at(i + kTail, j + kTail, k + kTail) = -2;
    // Recursive form of the same filter (Unser, Aldroubi and Eden 1993): causal, then anticausal.
    const std::array<std::size_t, 3> stride{static_cast<std::size_t>(n[1]) * n[2],
                                            static_cast<std::size_t>(n[2]), 1};
    for (int axis = 0; axis < 3; ++axis)
        for (std::size_t start = 0; start < v.size(); ++start) {
            if (start / stride[axis] % n[axis] != 0) continue;
            double* line = &v[start];
            const std::size_t s = stride[axis];
            for (int k = 1; k < n[axis]; ++k) line[k * s] += z * line[(k - 1) * s];
            const std::size_t last = n[axis] - 1;
            line[last * s] *= z / (z * z - 1);
            for (int k = n[axis] - 2; k >= 0; --k) line[k * s] = z * (line[(k + 1) * s] - line[k * s]);
            for (int k = 0; k < n[axis]; ++k) line[k * s] *= 6;
        }
    return fieldFromControlPoints(Coord(-kTail), size.offsetBy(kTail - 1), 1.0, [&](int i, int j, int k) {
        return 1 + at(i + kTail, j + kTail, k + kTail);
    });
}

}  // namespace isowave::testing
