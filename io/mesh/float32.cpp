#include "io/mesh/float32.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_set>

#include "io/mesh/equal_points.h"
#include "isowave/error.h"

namespace isowave {
namespace {

struct HashFloatPoint {
    std::size_t operator()(const FloatPoint& p) const {
        std::size_t h = 0;
        for (const float x : p) h = (h ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15u;
        return h ^ h >> 29;
    }
};

std::vector<FloatPoint> allToFloat(std::span<const Point> points) {
    std::vector<FloatPoint> floats(points.size());
    std::transform(points.begin(), points.end(), floats.begin(), [](const Point& p) { return toFloat(p); });
    return floats;
}

// The points that an earlier one equals.
std::vector<std::uint32_t> fusedOf(const std::vector<FloatPoint>& floats) {
    std::vector<Point> points(floats.size());
    std::transform(floats.begin(), floats.end(), points.begin(), [](const FloatPoint& p) {
        return Point{p[0], p[1], p[2]};
    });
    const DistinctPoints distinct = distinctPoints(points);
    std::vector<std::uint32_t> fused;
    for (std::uint32_t i = 0; i < points.size(); ++i)
        if (distinct.firsts[distinct.which[i]] != i) fused.push_back(i);
    return fused;
}

// The float32 points within 2 steps of `at` on each axis, nearest to `exact` first.
std::vector<FloatPoint> neighboursOf(const FloatPoint& at, const Vec3& exact, float step) {
    std::vector<FloatPoint> near;
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j)
            for (int k = -2; k <= 2; ++k)
                near.push_back({at[0] + static_cast<float>(i) * step, at[1] + static_cast<float>(j) * step,
                                at[2] + static_cast<float>(k) * step});
    std::stable_sort(near.begin(), near.end(), [&](const FloatPoint& a, const FloatPoint& b) {
        return length(toVec3(a) - exact) < length(toVec3(b) - exact);
    });
    return near;
}

}  // namespace

float stepAt(float x) { return std::nextafter(x, INFINITY) - x; }

std::vector<FloatPoint> separateFloats(std::span<const Point> points, const std::string& file,
                                       const char* format) {
    std::vector<FloatPoint> floats = allToFloat(points);
    float largest = 0;
    for (const FloatPoint& p : floats)
        for (const float x : p) {
            if (!std::isfinite(x))
                throw OperationError(file,
                                     fmt::format("a coordinate does not fit float32, which is all that {} "
                                                 "has; write PLY",
                                                 format));
            largest = std::max(largest, std::abs(x));
        }
    const std::vector<std::uint32_t> fused = fusedOf(floats);
    if (fused.empty()) return floats;

    const float step = stepAt(largest);
    std::unordered_set<FloatPoint, HashFloatPoint> taken(floats.begin(), floats.end());
    for (const std::uint32_t i : fused) {
        const auto near = neighboursOf(floats[i], toVec3(points[i]), step);
        const auto free =
            std::find_if(near.begin(), near.end(), [&](const auto& p) { return !taken.count(p); });
        if (free == near.end())
            throw OperationError(
                file,
                fmt::format("float32, which is all that {} has, cannot tell {} of {} vertices from their "
                            "neighbours (coordinates up to {}); write PLY, which can have float64",
                            format, fused.size(), points.size(), std::to_string(largest)));
        floats[i] = *free;
        taken.insert(*free);
    }
    return floats;
}

bool needsFloat64(const MeshView& mesh) {
    constexpr double kAllowed = 1e-4;  // of the mean edge
    double edges = 0, error = 0;
    for (const Triangle& t : mesh.triangles)
        for (int k = 0; k < 3; ++k)
            edges += length(toVec3(mesh.points[t[k]]) - toVec3(mesh.points[t[(k + 1) % 3]]));
    const double mean = edges / std::max<double>(1, 3.0 * static_cast<double>(mesh.triangles.size()));
    const std::vector<FloatPoint> floats = allToFloat(mesh.points);
    for (std::size_t i = 0; i < floats.size(); ++i)
        error = std::max(error, length(toVec3(floats[i]) - toVec3(mesh.points[i])));
    if (!(error <= kAllowed * mean)) return !mesh.triangles.empty();
    return !fusedOf(floats).empty();
}

}  // namespace isowave
