#include "solids.h"

#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "analytic.h"
#include "io/mesh/read.h"
#include "marching.h"
#include "volume/distance.h"
#include "volume/mesh_repair.h"

namespace isowave::bench {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

constexpr double kFiner = 0.5;  // spacing of the lattice on which functions are sampled
constexpr int kBlock = 8;

AnalyticSolid analyticSolid(const std::string& name, int voxels) {
    const int holes = std::max(2, (voxels - 28) / 32);  // 3 at 128, 6 at 256 (the plate is 209 wide)
    if (name == "plate") return plateSolid(std::min(holes, voxels / 42));
    if (name == "plate-turned") return turned(plateSolid(std::min(holes, voxels / 42)));
    if (name == "gyroid") return turned(gyroidBlock(32, 0.3 * voxels));
    if (name == "trabecular") return trabecularBall(24, 0.45 * voxels);
    return {};
}

// Samples f; blocks that the surface cannot reach get the sign of their middle.
DenseField sampled(const AnalyticSolid& solid) {
    DenseField field;
    const int reach = kBlock * (static_cast<int>(solid.extent / kFiner) / kBlock + 1);
    field.box = CoordBBox(Coord(-reach), Coord(reach - 1));
    field.spacing = kFiner;
    field.values.resize(field.box.volume());
    const int blocks = 2 * reach / kBlock;
    const double farthest = std::sqrt(3.0) / 2 * kBlock * kFiner * solid.slope;
    tbb::parallel_for(0, blocks * blocks * blocks, [&](int i) {
        const Coord block(i / blocks / blocks, i / blocks % blocks, i % blocks);
        const Coord low = field.box.min().offsetBy(kBlock * block[0], kBlock * block[1], kBlock * block[2]);
        const double middle = solid.value(field.place(low) + Vec3d(0.5 * kFiner * (kBlock - 1)));
        const bool sample = std::abs(middle) <= farthest;
        for (auto c = CoordBBox::createCube(low, kBlock).begin(); c; ++c)
            field.values[field.index(*c)] =
                static_cast<float>(sample ? solid.value(field.place(*c)) : middle);
    });
    return field;
}

FidelitySolid solidOf(std::string name, TriangleMesh mesh) {
    const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
    FidelitySolid solid{std::move(name), std::move(mesh), nullptr};
    solid.distance = distanceFromMesh(solid.truth, *transform, kWide);
    return solid;
}

TriangleMesh inVoxels(TriangleMesh mesh, const openvdb::math::Transform& transform) {
    for (Point& p : mesh.points) {
        const Vec3d q = transform.worldToIndex(Vec3d(p[0], p[1], p[2]));
        p = {q[0], q[1], q[2]};
    }
    mesh.normals.clear();
    return mesh;
}

std::string fileName(const std::string& path) {
    const auto slash = path.find_last_of('/');
    const std::string name = slash == std::string::npos ? path : path.substr(slash + 1);
    return name.substr(0, name.find('.'));
}

FidelitySolid solidOfImage(const std::string& path, double iso) {
    const Image image = readImage(path);
    FidelitySolid solid{fileName(path), {}, distanceFromImage(image, {.iso = iso}, kWide)};
    solid.distance->setTransform(openvdb::math::Transform::createLinearTransform(1.0));
    // Capped as isowave does it, half a voxel beyond the border.
    const Coord last(int(image.size[0]) - 1, int(image.size[1]) - 1, int(image.size[2]) - 1);
    const CoordBBox voxels(Coord(0), last);
    DenseField field;
    field.box = CoordBBox(Coord(-1), last.offsetBy(1));
    field.values.resize(field.box.volume());
    for (auto c = field.box.begin(); c; ++c) {
        const Coord v = Coord::minComponent(Coord::maxComponent(*c, Coord(0)), last);
        const std::size_t at = (std::size_t(v[2]) * image.size[1] + v[1]) * image.size[0] + v[0];
        const auto below = static_cast<float>(iso - image.values[at]);
        field.values[field.index(*c)] = voxels.isInside(*c) ? below : std::abs(below);
    }
    solid.truth = marchingCubes(field);
    return solid;
}

}  // namespace

FidelitySolid fidelitySolid(const std::string& name, int voxels) {
    if (const AnalyticSolid analytic = analyticSolid(name, voxels); analytic.value)
        return solidOf(name, marchingCubes(sampled(analytic)));
    if (const auto at = name.find('@'); at != std::string::npos)
        return solidOfImage(name.substr(0, at), std::stod(name.substr(at + 1)));
    const TriangleMesh mesh = repairMesh(readMesh(name), name);
    return solidOf(fileName(name), inVoxels(mesh, *transformForMesh(mesh, voxelForCount(mesh, voxels))));
}

openvdb::FloatGrid::Ptr clamped(const openvdb::FloatGrid& distance, double halfWidth) {
    const openvdb::FloatGrid::Ptr result = distance.deepCopy();
    const auto limit = static_cast<float>(halfWidth);
    for (auto value = result->beginValueOn(); value; ++value) {
        if (std::abs(*value) < limit) continue;
        value.setValue(std::copysign(limit, *value));
        value.setValueOff();
    }
    openvdb::tools::changeLevelSetBackground(result->tree(), limit);
    openvdb::tools::pruneLevelSet(result->tree());
    return result;
}

}  // namespace isowave::bench
