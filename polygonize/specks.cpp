#include "polygonize/specks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isowave {

double nodeVolume(const openvdb::math::Transform& transform) {
    return std::abs(transform.baseMap()->getAffineMap()->getMat4().getMat3().det());
}

namespace {

// smallest: of each component.
std::vector<bool> areSpecks(const std::vector<double>& volumes, const std::vector<double>& smallest) {
    std::vector<bool> result(volumes.size());
    for (std::size_t i = 0; i < volumes.size(); ++i) result[i] = std::abs(volumes[i]) < smallest[i];
    const auto largest = std::max_element(volumes.begin(), volumes.end());  // the first one of several
    if (largest != volumes.end()) result[static_cast<std::size_t>(largest - volumes.begin())] = false;
    return result;
}

// Of the components that are wanted, in their order.
std::vector<PointBox> boxesOf(const TriangleMesh& mesh, const MeshComponents& components,
                              const std::vector<bool>& wanted) {
    std::vector<PointBox> boxes(components.count());
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        if (components.of[v] != MeshComponents::kNone) boxes[components.of[v]].add(mesh.points[v]);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (wanted[i]) boxes[kept++] = boxes[i];
    boxes.resize(kept);
    return boxes;
}

SpeckRemoval removeThese(TriangleMesh& mesh, const MeshComponents& components,
                         const std::vector<bool>& isSpeck) {
    SpeckRemoval removal;
    for (std::size_t i = 0; i < components.count(); ++i) {
        if (!isSpeck[i]) continue;
        const double volume = components.volume[i];
        ++(volume < 0 ? removal.bubbles : removal.specks);
        (volume < 0 ? removal.bubbleVolume : removal.speckVolume) += std::abs(volume);
    }
    if (removal.specks + removal.bubbles == 0) return removal;
    removal.boxes = boxesOf(mesh, components, isSpeck);

    std::vector<std::uint32_t> renamed(mesh.points.size(), MeshComponents::kNone);
    std::uint32_t kept = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        if (components.of[v] == MeshComponents::kNone || isSpeck[components.of[v]]) continue;
        mesh.points[kept] = mesh.points[v];
        if (!mesh.normals.empty()) mesh.normals[kept] = mesh.normals[v];
        renamed[v] = kept++;
    }
    mesh.points.resize(kept);
    if (!mesh.normals.empty()) mesh.normals.resize(kept);
    std::size_t out = 0;
    for (const Triangle& t : mesh.triangles)
        if (renamed[t[0]] != MeshComponents::kNone)
            mesh.triangles[out++] = {renamed[t[0]], renamed[t[1]], renamed[t[2]]};
    mesh.triangles.resize(out);
    return removal;
}

}  // namespace

std::vector<bool> areSpecks(const std::vector<double>& volumes, double smallest) {
    return areSpecks(volumes, std::vector<double>(volumes.size(), smallest));
}

SpeckRemoval removeSpecks(TriangleMesh& mesh, double smallest) {
    if (!(smallest > 0)) return {};
    const MeshComponents components = componentsOf(mesh);
    return removeThese(mesh, components, areSpecks(components.volume, smallest));
}

SpeckRemoval removeSpecks(TriangleMesh& mesh, double smallest, MeshComponents& components) {
    if (!(smallest > 0)) return {};
    SpeckRemoval removal = removeThese(mesh, components, areSpecks(components.volume, smallest));
    if (removal.specks + removal.bubbles != 0) components = componentsOf(mesh);
    return removal;
}

SpeckRemoval removeSpecks(TriangleMesh& mesh, const std::vector<double>& smallestAt) {
    const MeshComponents components = componentsOf(mesh);
    std::vector<double> smallest(components.count(), std::numeric_limits<double>::infinity());
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        if (const auto c = components.of[v]; c != MeshComponents::kNone)
            smallest[c] = std::min(smallest[c], smallestAt[v]);
    return removeThese(mesh, components, areSpecks(components.volume, smallest));
}

double volumeWithoutSpecks(const TriangleMesh& mesh, double smallest) {
    const MeshComponents components = componentsOf(mesh);
    const std::vector<bool> isSpeck = areSpecks(components.volume, smallest);
    double volume = 0;
    for (std::size_t i = 0; i < components.count(); ++i)
        if (!isSpeck[i]) volume += components.volume[i];
    return volume;
}

}  // namespace isowave
