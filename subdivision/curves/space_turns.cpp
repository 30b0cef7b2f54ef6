#include "subdivision/curves/space_turns.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace isowave::subdivision {
namespace {

using Eigen::Matrix3d, Eigen::Vector3d;

constexpr double kOfAll = 1e-3;
constexpr double kStraight = 1e-6;  // of the largest singular value

Vector3d pointOf(const Polyline& curve, std::size_t i) {
    return {curve.coordinates[3 * i], curve.coordinates[3 * i + 1], curve.coordinates[3 * i + 2]};
}

// Sums of products, so that a sum of nothing but itself has the norm 1 or less.
struct Sum {
    Matrix3d products = Matrix3d::Zero();
    double size = 0;

    void add(const Vector3d& a, const Vector3d& b) {
        products += a * b.transpose();
        size += a.norm() * b.norm();
    }
    Matrix3d mean() const { return size > 0 ? Matrix3d(products / size) : Matrix3d(Matrix3d::Zero()); }
};

Matrix3d ofAll(const Polyline& before, const Polyline& after) {
    Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
    const std::size_t n = before.size();
    for (std::size_t i = 0; i < n; ++i) a += pointOf(before, i), b += pointOf(after, i);
    Sum sum;
    for (std::size_t i = 0; i < n; ++i)
        sum.add(pointOf(before, i) - a / static_cast<double>(n),
                pointOf(after, i) - b / static_cast<double>(n));
    return sum.mean();
}

// The neighbours of point i, at most two steps away.
std::vector<std::size_t> neighboursOf(const Polyline& curve, std::size_t i) {
    const auto n = static_cast<std::ptrdiff_t>(curve.size());
    std::vector<std::size_t> all;
    for (const std::ptrdiff_t step : {-2, -1, 1, 2}) {
        std::ptrdiff_t k = static_cast<std::ptrdiff_t>(i) + step;
        if (curve.closed) k = ((k % n) + n) % n;
        if (0 <= k && k < n && k != static_cast<std::ptrdiff_t>(i))
            all.push_back(static_cast<std::size_t>(k));
    }
    return all;
}

// From the direction in which a straight curve runs to that of the other one: the largest singular vectors.
Matrix3d leastTurn(const Vector3d& from, const Vector3d& to) {
    return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

Matrix3d rotationOf(const Matrix3d& products) {
    const Eigen::JacobiSVD<Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vector3d size = svd.singularValues();
    if (!(size[0] > 0)) return Matrix3d::Identity();
    if (size[1] <= kStraight * size[0]) return leastTurn(svd.matrixU().col(0), svd.matrixV().col(0));
    Vector3d signs(1, 1, 1);
    if ((svd.matrixV() * svd.matrixU().transpose()).determinant() < 0) signs[2] = -1;
    return svd.matrixV() * signs.asDiagonal() * svd.matrixU().transpose();
}

}  // namespace

SpaceTurns::SpaceTurns(const Polyline& before, const Polyline& after) {
    assert(before.dimension == 3 && after.dimension == 3 && before.size() == after.size());
    const Matrix3d all = kOfAll * ofAll(before, after);
    rows_.reserve(before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
        Sum sum;
        for (const std::size_t k : neighboursOf(before, i))
            sum.add(pointOf(before, k) - pointOf(before, i), pointOf(after, k) - pointOf(after, i));
        const Matrix3d r = rotationOf(sum.mean() + all);
        std::array<Vec3, 3>& rows = rows_.emplace_back();
        for (int row = 0; row < 3; ++row)
            rows[static_cast<std::size_t>(row)] = {r(row, 0), r(row, 1), r(row, 2)};
    }
}

Vec3 SpaceTurns::turned(std::size_t point, const Vec3& d) const {
    const std::array<Vec3, 3>& rows = rows_[point];
    return {dot(rows[0], d), dot(rows[1], d), dot(rows[2], d)};
}

}  // namespace isowave::subdivision
