// thin_parts SOLID [LEVELS]: what becomes of thin walls, level by level, as a markdown table: the wavelet levels as they
// are, with --protect-thin, and what people use today.
//
//   SOLID     plate: a plate with 36 holes of radius 1.2 to 8 voxels, a wall of 2 voxels and 12 balls
//             gyroid: a shell 2 voxels thick along a gyroid of period 48, in a ball of radius 60
//             or a closed mesh (sampled with 256 voxels), or an image that ITK reads, followed by @ISO
//   multires  openvdb::tools::MultiResGrid of the same distances, volumeToMesh
//   dilate    the voxels of the solid, a coarse one is inside where any of its 2x2x2 is: what igneous' thickened
//             down-sampling comes to, and the cure that users are told (seung-lab/igneous#103)
// parts, genus, cavities: of the mesh, specks removed in all rows; volume: against level 0.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>

#include "analytic.h"
#include "io/mesh/read.h"
#include "multires.h"
#include "polygonize/knot_insertion.h"
#include "polygonize/level_iso.h"
#include "polygonize/polygonize.h"
#include "polygonize/specks.h"
#include "volume/distance.h"
#include "volume/fit.h"
#include "volume/mesh_repair.h"
#include "wavelets/pyramid.h"

namespace {

using namespace isowave;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

constexpr double kHalfWidth = 4;

// Turned about z, so that nothing repeats on the lattice.
Vec3d turned(const Vec3d& p, double angle) {
    return {std::cos(angle) * p[0] + std::sin(angle) * p[1], std::cos(angle) * p[1] - std::sin(angle) * p[0],
            p[2]};
}

double gyroid(const Vec3d& at) {
    const Vec3d p = turned(at, 0.64) * (2 * std::numbers::pi / 48);
    const Vec3d s(std::sin(p[0]), std::sin(p[1]), std::sin(p[2])),
        c(std::cos(p[0]), std::cos(p[1]), std::cos(p[2]));
    const double value = s[0] * c[1] + s[1] * c[2] + s[2] * c[0];
    const Vec3d gradient(c[0] * c[1] - s[2] * s[0], c[1] * c[2] - s[0] * s[1], c[2] * c[0] - s[1] * s[2]);
    const double distance = std::abs(value) / (std::max(gradient.length(), 0.35) * 2 * std::numbers::pi / 48);
    return std::max(distance - 1, at.length() - 60);
}

openvdb::FloatGrid::Ptr distanceOf(const std::string& solid) {
    if (solid == "plate")
        return distanceFromFunction([](const Vec3d& p) { return bench::plate(turned(p, 0.2), 6); },
                                    {Coord(-126, -126, -14), Coord(126, 126, 52)}, kHalfWidth);
    if (solid == "gyroid") return distanceFromFunction(gyroid, {Coord(-66), Coord(66)}, kHalfWidth);
    if (const auto at = solid.find('@'); at != std::string::npos)
        return distanceFromImage(readImage(solid.substr(0, at)), {.iso = std::stod(solid.substr(at + 1))},
                                 kHalfWidth);
    const TriangleMesh mesh = repairMesh(readMesh(solid), solid);
    return distanceFromMesh(mesh, *transformForMesh(mesh, voxelForCount(mesh, 256)), kHalfWidth);
}

struct Row {
    std::string name;
    MeshTopology topology;
    std::string iso;
};

Row counted(std::string name, TriangleMesh mesh, double node, std::string iso = {}) {
    removeSpecks(mesh, node);
    return {std::move(name), mesh.triangles.empty() ? MeshTopology{} : topologyOf(mesh), std::move(iso)};
}

// One level up: inside where any of 2x2x2 is. Lattice point j holds 2j .. 2j + 1.
openvdb::BoolGrid::Ptr dilatedHalf(const openvdb::BoolGrid& fine) {
    auto coarse = openvdb::BoolGrid::create(false);
    auto transform = fine.transform().copy();
    transform->preScale(2);
    transform->preTranslate(Vec3d(0.25));
    coarse->setTransform(transform);
    auto accessor = coarse->getAccessor();
    for (auto voxel = fine.cbeginValueOn(); voxel; ++voxel) accessor.setValueOn(voxel.getCoord() >> 1, true);
    return coarse;
}

TriangleMesh maskMesh(const openvdb::BoolGrid& mask) { return polygonize(fitBinary(nodesFromSigns(mask))); }

openvdb::BoolGrid::Ptr maskOf(const openvdb::FloatGrid& distance) {
    auto mask = openvdb::BoolGrid::create(false);
    mask->setTransform(distance.transform().copy());
    auto accessor = mask->getAccessor();
    for (auto value = distance.cbeginValueAll(); value; ++value) {
        if (*value >= 0) continue;
        if (value.isVoxelValue())
            accessor.setValueOn(value.getCoord(), true);
        else
            mask->tree().sparseFill(value.getBoundingBox(), true, true);
    }
    mask->tree().voxelizeActiveTiles();
    return mask;
}

void print(int level, const Row& row, double volume0) {
    const MeshTopology& t = row.topology;
    std::cout << fmt::format("| {} | {} | {} | {} | {} | {:+.1f} % | {} |\n", level, row.name, t.parts,
                             t.genus, t.cavities, 100 * (t.volume / volume0 - 1), row.iso);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::cerr << "usage: thin_parts plate|gyroid|MESH|IMAGE@ISO [LEVELS]\n";
        return 2;
    }
    initializeVdb();
    const int levels = argc > 2 ? std::atoi(argv[2]) : 3;
    const openvdb::FloatGrid::Ptr distance = distanceOf(argv[1]);
    const BSplineField finest = fitDistance(*distance);
    const ThinParts thin(finest);
    const bench::MultiRes grids(static_cast<std::size_t>(levels) + 1, *distance);
    openvdb::BoolGrid::Ptr mask = maskOf(*distance);
    const Row start = counted("level 0", polygonize(finest), 0);
    std::cout << "| level | | parts | genus | cavities | volume | |\n|---|---|---|---|---|---|---|\n";
    print(0, start, start.topology.volume);
    wavelets::analyse(finest, {.maxSteps = 3 * levels}, {}, [&](int step, const BSplineField& field) {
        if (step == 0 || step % 3 != 0) return;
        const int level = step / 3;
        const double node = nodeVolume(field.transform());
        for (const int refine : {1, 2}) {
            const std::string with = refine == 1 ? "" : " --refine 2";
            const std::vector<double> values =
                thin.valuesOn(refine == 1 ? field : insertKnots(field), field.transform().voxelSize());
            const Row plain =
                counted("as it is" + with, polygonize(field, {.refine = refine}), node,
                        fmt::format("{:.1f} % of thin parts kept", 100 * shareInside(values, 0)));
            print(level, plain, start.topology.volume);
            const double iso = isoThatKeeps(values, ThinParts::kShare, kIsoLimit * field.K);
            Row kept =
                counted("--protect-thin" + with, polygonize(field, {.refine = refine, .iso = iso}), node);
            const double moved = (kept.topology.volume - plain.topology.volume) /
                                 ((kept.topology.area + plain.topology.area) / 2);
            kept.iso = fmt::format("{:.1f} % kept, iso {:+.3f} K, surface moved {:.2f} voxels of the level",
                                   100 * shareInside(values, iso), iso / field.K, moved / std::cbrt(node));
            print(level, kept, start.topology.volume);
        }
        print(level, counted("multires", bench::multiresMesh(grids, level), node), start.topology.volume);
        mask = dilatedHalf(*mask);
        print(level, counted("dilate", maskMesh(*mask), node), start.topology.volume);
    });
    return 0;
}
