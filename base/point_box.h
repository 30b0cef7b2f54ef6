// A box along the axes around points.
#pragma once

#include <algorithm>
#include <limits>

#include "isowave/mesh.h"

namespace isowave {

struct PointBox {
    static constexpr double kAll = std::numeric_limits<double>::infinity();
    Point low{kAll, kAll, kAll}, high{-kAll, -kAll, -kAll};  // of no point

    void add(const Point& p) {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    double extent(int axis) const { return high[axis] - low[axis]; }
    Point centre() const { return {low[0] + extent(0) / 2, low[1] + extent(1) / 2, low[2] + extent(2) / 2}; }
    bool contains(const Point& p) const {
        bool in = true;
        for (int a = 0; a < 3; ++a) in = in && low[a] <= p[a] && p[a] <= high[a];
        return in;
    }
};

// Around the points that triangles use.
inline PointBox boxAround(const TriangleMesh& mesh) {
    PointBox box;
    for (const Triangle& t : mesh.triangles)
        for (const std::uint32_t v : t) box.add(mesh.points[v]);
    return box;
}

}  // namespace isowave
