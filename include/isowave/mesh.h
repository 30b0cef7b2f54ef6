// The one mesh type of isowave: an indexed triangle mesh in world coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace isowave {

using Point = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;

struct TriangleMesh {
    std::vector<Point> points;                     // world units (millimetres for images)
    std::vector<Triangle> triangles;               // counter-clockwise seen from outside
    std::vector<std::array<float, 3>> normals;     // one unit vector a point, pointing outside; or empty
};

}  // namespace isowave
