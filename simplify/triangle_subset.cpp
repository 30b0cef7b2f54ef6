#include "simplify/triangle_subset.h"

namespace isowave {

TriangleMesh evenSubset(const TriangleMesh& mesh, std::size_t atMost) {
    const std::size_t stride = (mesh.triangles.size() + atMost - 1) / atMost;
    if (stride <= 1) return mesh;
    TriangleMesh result;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
        const auto first = static_cast<std::uint32_t>(result.points.size());
        for (const std::uint32_t v : mesh.triangles[i]) result.points.push_back(mesh.points[v]);
        result.triangles.push_back({first, first + 1, first + 2});
    }
    return result;
}

}  // namespace isowave
