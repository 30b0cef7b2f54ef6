// Triangles of a mesh as vectors: the one place for normals and areas.
#pragma once

#include "isowave/mesh.h"

namespace isowave {

inline Vec3 toVec3(const Point& p) { return {p[0], p[1], p[2]}; }

// (b - a) x (c - a) of a triangle abc: the direction from which it is seen counter-clockwise, as long as
// twice its area.
inline Vec3 areaNormal(const TriangleMesh& mesh, const Triangle& t) {
    const Vec3 a = toVec3(mesh.points[t[0]]);
    return cross(toVec3(mesh.points[t[1]]) - a, toVec3(mesh.points[t[2]]) - a);
}

}  // namespace isowave
