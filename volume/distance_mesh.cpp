#include "volume/distance_mesh.h"

#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "base/point_box.h"
#include "base/triangle.h"
#include "volume/distance/buried.h"
#include "volume/distance/triangle_band.h"
#include "volume/leaf_words.h"
#include "volume/linear_transform.h"
#include "volume/mesh_winding.h"
#include "volume/sign_tiles.h"

namespace isowave {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

double areaOf(const TriangleMesh& mesh) {
    double twice = 0.0;
    for (const Triangle& t : mesh.triangles) twice += length(areaNormal(mesh, t));
    return twice / 2;
}

constexpr float kLeast = 1.0f / (1 << 20);

// The distances that a leaf holds, signed.
void sign(Leaf& leaf, const LatticeLines& lines, float halfWidth) {
    static_assert(Leaf::DIM == 8, "inside8 covers a row of a leaf");
    std::array<unsigned, 64> inside;
    for (int row = 0; row < 64; ++row)
        inside[static_cast<std::size_t>(row)] = lines.inside8(leaf.origin().offsetBy(0, row >> 3, row & 7));
    float* values = leaf.buffer().data();
    LeafWords active{};
    for (std::size_t n = 0; n < Leaf::SIZE; ++n) {
        const float distance = std::max(values[n], kLeast);
        active[n >> 6] |= std::uint64_t(distance < halfWidth) << (n & 63);
        values[n] = inside[n & 63] >> (n >> 6) & 1 ? -distance : distance;
    }
    leaf.setValueMask(maskOf(active));
}

// The distances that a leaf holds less `radius`, up to halfWidth.
void thicken(Leaf& leaf, double halfWidth, double radius) {
    float* values = leaf.buffer().data();
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
        double value = double(values[n]) - radius;
        if (std::abs(value) < kLeast) value = value < 0 ? -kLeast : kLeast;
        values[n] = static_cast<float>(std::clamp(value, -halfWidth, halfWidth));
        leaf.setActiveState(n, std::abs(values[n]) < static_cast<float>(halfWidth));
    }
}

// Whether parts of the surface are buried in the solid, seen along any axis: a face seen edge-on is crossed
// by none of the lines along it.
bool hasBuried(const LatticeLines& alongX, const std::vector<openvdb::Vec3d>& points,
               const std::vector<Triangle>& triangles, bool evenOdd, const Progress& progress) {
    if (alongX.hasBuried()) return true;
    std::vector<openvdb::Vec3d> turned = points;
    for (int axis = 1; axis < 3; ++axis) {
        for (openvdb::Vec3d& p : turned) p = {p.y(), p.z(), p.x()};
        if (LatticeLines(turned, triangles, evenOdd, progress).hasBuried()) return true;
    }
    return false;
}

}  // namespace

openvdb::FloatGrid::Ptr distanceFromMesh(const TriangleMesh& mesh, const openvdb::math::Transform& transform,
                                         double halfWidth, bool evenOdd, const Progress& progress) {
    assert(halfWidth >= 1.0);
    progress("finding the inside", 0.0);
    std::vector<openvdb::Vec3d> points;
    points.reserve(mesh.points.size());
    for (const Point& p : mesh.points) points.push_back(transform.worldToIndex(openvdb::Vec3d(p.data())));
    const LatticeLines lines(points, mesh.triangles, evenOdd, progress);

    progress("measuring distances", 0.0);
    const auto width = static_cast<float>(halfWidth);
    auto grid = openvdb::FloatGrid::create(width);
    auto made = leavesAround(
        points, mesh.triangles, halfWidth, [&](Leaf& leaf) { sign(leaf, lines, width); }, progress);
    hangLeaves(made, grid->tree());
    signTiles(grid->tree(), lines.box(), width, [&](const openvdb::Coord& p) { return lines.inside(p); });
    if (hasBuried(lines, points, mesh.triangles, evenOdd, progress)) {
        liftFromBuried(grid->tree(), halfWidth, progress);
    }
    openvdb::tools::prune(grid->tree());
    grid->setTransform(transform.copy());
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName("distance");
    return grid;
}

openvdb::FloatGrid::Ptr distanceAroundMesh(const TriangleMesh& mesh,
                                           const openvdb::math::Transform& transform, double halfWidth,
                                           double thickness, const Progress& progress) {
    assert(halfWidth >= 1.0 && thickness > 0 && !mesh.triangles.empty());
    const double radius = thickness / 2 / transform.voxelSize().x();
    progress("measuring distances", 0.0);
    std::vector<openvdb::Vec3d> points;
    points.reserve(mesh.points.size());
    for (const Point& p : mesh.points) points.push_back(transform.worldToIndex(openvdb::Vec3d(p.data())));
    auto grid = openvdb::FloatGrid::create(static_cast<float>(halfWidth));
    // Every point inside is nearer than the radius, so that it lies in one of these leaves.
    auto leaves = leavesAround(
        points, mesh.triangles, halfWidth + radius, [&](Leaf& leaf) { thicken(leaf, halfWidth, radius); },
        progress);
    hangLeaves(leaves, grid->tree());
    openvdb::tools::prune(grid->tree());
    grid->setTransform(transform.copy());
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName("distance");
    return grid;
}

double voxelForCount(const TriangleMesh& mesh, double voxels) {
    assert(voxels > 0 && !mesh.triangles.empty());
    const PointBox bounds = boxAround(mesh);
    return std::max({bounds.extent(0), bounds.extent(1), bounds.extent(2)}) / voxels;
}

openvdb::math::Transform::Ptr transformForMesh(const TriangleMesh& mesh, double voxel) {
    assert(voxel > 0 && !mesh.triangles.empty());
    const double offset = (3.0 - std::sqrt(5.0)) / 2.0;
    const PointBox bounds = boxAround(mesh);
    auto transform = linearTransform(voxel, "mesh");
    transform->postTranslate(openvdb::Vec3d(bounds.low.data()) - openvdb::Vec3d(offset * voxel));
    return transform;
}

double estimateBandVoxels(const TriangleMesh& mesh, double voxel, double halfWidth) {
    assert(voxel > 0 && halfWidth > 0 && !mesh.triangles.empty());
    const PointBox bounds = boxAround(mesh);
    double box = 1.0;
    for (int axis = 0; axis < 3; ++axis) box *= bounds.extent(axis) / voxel + 2 * halfWidth;
    return std::min(box, areaOf(mesh) / (voxel * voxel) * 2 * halfWidth);
}

}  // namespace isowave
