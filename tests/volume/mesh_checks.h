// What the tests of mesh input share: shapes to break, and answers found the slow way.
#pragma once

#include <openvdb/math/Proximity.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "simplify/shapes.h"
#include "volume/vdb.h"

namespace isowave::checks {

inline TriangleMesh box(const Point& low, const Point& high) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.points.push_back({(i & 1 ? high : low)[0], (i & 2 ? high : low)[1], (i & 4 ? high : low)[2]});
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

inline TriangleMesh reversed(TriangleMesh mesh) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

// A ball with a void in it and a ball in the void; none of the radii a whole number.
inline TriangleMesh nestedShells(int level, const Point& centre) {
    using shapes::sphere, shapes::together;
    return together(together(sphere(15.3, level, centre), reversed(sphere(10.7, level, centre))),
                    sphere(5.2, level, centre));
}

// Every edge is used equally often both ways, by an even number of triangles: closed and consistently
// oriented.
inline bool isClosedAndOriented(const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
    for (const Triangle& t : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            const auto a = t[i], b = t[(i + 1) % 3];
            balance[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    return std::all_of(balance.begin(), balance.end(), [](const auto& edge) { return edge.second == 0; });
}

inline double volumeOf(const TriangleMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const openvdb::Vec3d a(mesh.points[t[0]].data()), b(mesh.points[t[1]].data()),
            c(mesh.points[t[2]].data());
        sum += a.dot(b.cross(c)) / 6;
    }
    return sum;
}

// Winding number of a point off the surface: the solid angle under which it sees the mesh, over 4 pi.
// van Oosterom, Strackee: "The solid angle of a plane triangle".
inline double windingNumber(const TriangleMesh& mesh, const openvdb::Vec3d& p) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const openvdb::Vec3d a = openvdb::Vec3d(mesh.points[t[0]].data()) - p,
                             b = openvdb::Vec3d(mesh.points[t[1]].data()) - p,
                             c = openvdb::Vec3d(mesh.points[t[2]].data()) - p;
        const double la = a.length(), lb = b.length(), lc = c.length();
        sum +=
            2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return sum / (4 * M_PI);
}

inline double distanceTo(const TriangleMesh& mesh, const openvdb::Vec3d& p) {
    double least = HUGE_VAL;
    openvdb::Vec3d barycentric;
    for (const Triangle& t : mesh.triangles) {
        const auto q = openvdb::math::closestPointOnTriangleToPoint(
            openvdb::Vec3d(mesh.points[t[0]].data()), openvdb::Vec3d(mesh.points[t[1]].data()),
            openvdb::Vec3d(mesh.points[t[2]].data()), p, barycentric);
        least = std::min(least, (q - p).length());
    }
    return least;
}

inline std::vector<openvdb::Vec3d> vectorsOf(const TriangleMesh& mesh) {
    std::vector<openvdb::Vec3d> points;
    for (const Point& p : mesh.points) points.emplace_back(p.data());
    return points;
}

}  // namespace isowave::checks
