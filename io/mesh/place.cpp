#include "io/mesh/place.h"

#include <array>
#include <type_traits>
#include <vector>

namespace isowave {
namespace {

// + 0.0 turns -0 into 0, which are one point to a reader.
template <class Real, class Turn>
void turnAll(std::vector<std::array<Real, 3>>& vectors, const Turn& turn) {
    for (auto& v : vectors) {
        v = turn(v);
        for (Real& x : v) x += Real{0};
    }
}

}  // namespace

void placeFor(MeshFormat format, const MeshWriteOptions& options, TriangleMesh& mesh) {
    const auto halfTurn = [](const auto& p) { return std::decay_t<decltype(p)>{-p[0], -p[1], p[2]}; };
    const auto yUp = [](const auto& p) { return std::decay_t<decltype(p)>{p[0], p[2], -p[1]}; };
    if (options.space == Space::ras) {
        turnAll(mesh.points, halfTurn);
        turnAll(mesh.normals, halfTurn);
    }
    if (format != MeshFormat::glb) return;
    turnAll(mesh.points, yUp);
    turnAll(mesh.normals, yUp);
    for (Point& p : mesh.points)
        for (double& x : p) x *= options.metresPerUnit;
}

}  // namespace isowave
