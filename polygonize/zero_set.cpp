#include "polygonize/zero_set.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/triangle.h"

namespace isowave {
namespace {

using openvdb::Vec3d;

Vec3d toVec(const Point& p) { return {p[0], p[1], p[2]}; }

constexpr std::size_t kChunk = 1024;  // triangles handed to a thread at once

struct Sums {
    double area = 0, square = 0, max = 0;
};

// The integral of the square over a triangle is taken as area/4 times the sum over its four samples.
void addTriangle(const ZeroSet& surface, const std::array<Vec3d, 3>& corners, Sums& sums) {
    const auto& [a, b, c] = corners;
    const double area = (b - a).cross(c - a).length() / 2;
    sums.area += area;
    for (const Vec3d& p : {(a + b) / 2, (b + c) / 2, (c + a) / 2, (a + b + c) / 3}) {
        double distance = std::min({(p - a).length(), (p - b).length(), (p - c).length()});
        if (const auto foot = surface.foot(p)) distance = std::min(distance, (foot->at - p).length());
        sums.square += area / 4 * distance * distance;
        sums.max = std::max(sums.max, distance);
    }
}

}  // namespace

ZeroSet::ZeroSet(const BSplineField& field, double iso) : field_(field), iso_(iso) {
    const auto matrix = field.transform().baseMap()->getAffineMap()->getMat4();
    worldToIndex_ = matrix.inverse();
    gradientToWorld_ = matrix.getMat3().inverse();
    const Vec3d sides = field.transform().voxelSize();
    voxel_ = std::min({sides[0], sides[1], sides[2]});
}

std::optional<ZeroSet::Foot> ZeroSet::foot(const Vec3d& point) const {
    constexpr int kSteps = 30;
    Vec3d at = point;
    for (int step = 0; step < kSteps; ++step) {
        const Vec3d index = at * worldToIndex_;
        const double value = evaluate(field_, index) - iso_;
        const Vec3d gradient = gradientToWorld_ * evaluateGradient(field_, index);
        const double slope2 = gradient.lengthSqr();
        if (!(slope2 > 0)) return {};
        const Vec3d move = -value / slope2 * gradient;
        at += move;
        if (!((at - point).length() <= kReach * voxel_)) return {};
        if (move.length() <= kSettled * voxel_) return Foot{at, gradient / std::sqrt(slope2)};
    }
    return {};
}

std::vector<std::array<float, 3>> ZeroSet::normalsOf(const TriangleMesh& mesh,
                                                     const Progress& progress) const {
    std::vector<Vec3d> sums(mesh.points.size(), Vec3d(0.0));
    for (const Triangle& t : mesh.triangles) {
        const Vec3 normal = areaNormal(mesh, t);
        for (const std::uint32_t v : t) sums[v] += Vec3d(normal.x, normal.y, normal.z);
    }
    std::vector<std::array<float, 3>> normals(mesh.points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, normals.size(), kChunk), [&](const auto& range) {
        progress.check();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const std::optional<Foot> found = foot(toVec(mesh.points[i]));
            const double length = sums[i].length();
            const Vec3d n = found ? found->normal : length > 0 ? sums[i] / length : Vec3d(0, 0, 1);
            normals[i] = {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
        }
    });
    return normals;
}

Deviation deviationFrom(const ZeroSet& surface, const TriangleMesh& mesh, const Progress& progress) {
    std::vector<Sums> sums((mesh.triangles.size() + kChunk - 1) / kChunk);
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t chunk) {
        progress.check();
        const std::size_t last = std::min(mesh.triangles.size(), (chunk + 1) * kChunk);
        for (std::size_t i = chunk * kChunk; i < last; ++i) {
            const Triangle& t = mesh.triangles[i];
            addTriangle(surface,
                        {toVec(mesh.points[t[0]]), toVec(mesh.points[t[1]]), toVec(mesh.points[t[2]])},
                        sums[chunk]);
        }
    });
    Sums total;
    for (const Sums& s : sums) {
        total.area += s.area;
        total.square += s.square;
        total.max = std::max(total.max, s.max);
    }
    return {total.max, total.area > 0 ? std::sqrt(total.square / total.area) : 0,
            4 * static_cast<std::int64_t>(mesh.triangles.size())};
}

}  // namespace isowave
