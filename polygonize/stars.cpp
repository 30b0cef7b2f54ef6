#include "polygonize/stars.h"

#include <numeric>

namespace isowave {

Stars starsOf(const TriangleMesh& mesh) {
    Stars stars;
    stars.first.assign(mesh.points.size() + 1, 0);
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t))
            for (const std::uint32_t v : t) ++stars.first[v + 1];
    std::partial_sum(stars.first.begin(), stars.first.end(), stars.first.begin());
    stars.corners.resize(stars.first.back());
    std::vector<std::size_t> next(stars.first.begin(), stars.first.end() - 1);
    for (const Triangle& t : mesh.triangles)
        if (!isDegenerate(t))
            for (int k = 0; k < 3; ++k) stars.corners[next[t[k]]++] = {t[(k + 1) % 3], t[(k + 2) % 3]};
    return stars;
}

}  // namespace isowave
