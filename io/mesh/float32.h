// What float32 leaves of points in float64.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "io/mesh/view.h"
#include "isowave/mesh.h"

namespace isowave {

using FloatPoint = std::array<float, 3>;

inline FloatPoint toFloat(const Vec3& p) {
    return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}
inline FloatPoint toFloat(const Point& p) { return toFloat(Vec3{p[0], p[1], p[2]}); }
inline Vec3 toVec3(const Point& p) { return {p[0], p[1], p[2]}; }
inline Vec3 toVec3(const FloatPoint& p) { return {p[0], p[1], p[2]}; }

// The distance from a float32 number to the next larger one.
float stepAt(float x);

// Different points as different float32 triples, so that a reader that merges by position, and only that, finds the mesh's
// own vertices again: of those that round to the same triple the first gets it, the others the nearest free one, at most 2
// steps (at the largest coordinate) away on each axis. Throws OperationError, with the file's name and its format's, where
// none is free or a coordinate does not fit.
std::vector<FloatPoint> separateFloats(std::span<const Point> points, const std::string& file,
                                       const char* format);

// Whether float32 would move a point by more than 1e-4 of the mean edge, or make two points one.
bool needsFloat64(const MeshView& mesh);

}  // namespace isowave
