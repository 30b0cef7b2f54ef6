// The star of each vertex of a mesh: the triangles at it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

// Two equal corners (by index): such a triangle has no edges and is in no star.
inline bool isDegenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

struct Stars {
    // A triangle (v, next, previous) of the star of v, counter-clockwise.
    struct Corner {
        std::uint32_t next, previous;
    };
    std::vector<std::size_t> first;  // of vertex v: corners[first[v] .. first[v + 1])
    std::vector<Corner> corners;     // in the order of the mesh's triangles
};

// By one counting sort of corners by vertex.
Stars starsOf(const TriangleMesh& mesh);

}  // namespace isowave
