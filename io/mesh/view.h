// What the writers of mesh files are given: triangles, or polygons of any size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

// Of `triangles` and `corners` + `faceBegin` (as in PolygonSoup) one is empty. The two kinds are printed differently. A
// mesh of triangles is a result: the shortest decimals, float32 in PLY where that is enough, a comment that names the
// program. A mesh of polygons is somebody's model on its way through: decimals without exponents up to 1e16, float64 in PLY.
struct MeshView {
    std::span<const Point> points;
    std::span<const std::array<float, 3>> normals;  // one a point, or none
    std::span<const Triangle> triangles;
    std::span<const std::uint32_t> corners, faceBegin;
    std::vector<std::string> tags;  // as MeshTag::text
    Space space = Space::unspecified;
    std::span<const float> distances;  // to level 0, world units, one a point, or none
    double distanceRange = 0;          // of the last colour
    double metresPerUnit = 0.001;

    bool isPolygons() const { return !faceBegin.empty(); }
    std::size_t faceCount() const { return isPolygons() ? faceBegin.size() - 1 : triangles.size(); }
    std::span<const std::uint32_t> face(std::size_t f) const {
        if (!isPolygons()) return triangles[f];
        return corners.subspan(faceBegin[f], faceBegin[f + 1] - faceBegin[f]);
    }
    // The comments that a file starts with.
    std::vector<std::string> comments() const {
        std::vector<std::string> lines;
        if (!isPolygons()) lines.push_back("isowave");
        if (space != Space::unspecified) lines.push_back(space == Space::lps ? "SPACE=LPS" : "SPACE=RAS");
        return lines;
    }
};

}  // namespace isowave
