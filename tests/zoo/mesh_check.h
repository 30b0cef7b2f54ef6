// A second opinion on a mesh, by other means than polygonize/topology: hash maps of edges and corners, no
// sorting, no shared code.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "isowave/mesh.h"

namespace isowave::zoo {

// Empty when every edge has exactly two triangles that run along it in opposite directions and the triangles
// round every vertex form one closed fan; otherwise what is wrong first.
inline std::string whatIsWrongWith(const TriangleMesh& mesh) {
    // next[v -> a] = b for a triangle (v, a, b): walking on from a must visit all triangles of v and come
    // back.
    std::unordered_map<std::uint64_t, std::uint32_t> next;
    const auto key = [](std::uint32_t a, std::uint32_t b) { return std::uint64_t(a) << 32 | b; };
    std::vector<std::uint32_t> triangles(mesh.points.size(), 0), first(mesh.points.size(), 0);
    next.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t v = t[i], a = t[(i + 1) % 3], b = t[(i + 2) % 3];
            if (v == a || a == b) return "a triangle with two equal corners";
            if (!next.emplace(key(v, a), b).second)
                return "an edge with two triangles that run the same way along it";
            ++triangles[v];
            first[v] = a;
        }
    for (std::uint32_t v = 0; v < mesh.points.size(); ++v) {
        if (triangles[v] == 0) return "a point without triangle";
        std::uint32_t a = first[v];
        for (std::uint32_t step = 0; step < triangles[v]; ++step) {
            const auto at = next.find(key(v, a));
            if (at == next.end()) return "an edge with one triangle";
            a = at->second;
            if (a == first[v] && step + 1 != triangles[v]) return "a vertex with two fans";
        }
        if (a != first[v]) return "a vertex whose fan does not close";
    }
    return {};
}

}  // namespace isowave::zoo
