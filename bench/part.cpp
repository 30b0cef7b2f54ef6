#include "part.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace isowave::bench {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Leaf = openvdb::FloatTree::LeafNodeType;
using Upper = openvdb::FloatTree::RootNodeType::ChildNodeType;
using Lower = Upper::ChildNodeType;

// Half the diagonal of a cube of `edge` voxels.
double reach(int edge) { return std::sqrt(3.0) / 2 * edge; }

Vec3d centre(const Coord& origin, int edge) { return origin.asVec3d() + Vec3d(0.5 * (edge - 1)); }

// The leaf at origin, or null where the surface is too far away.
std::unique_ptr<Leaf> sampleLeaf(const PerforatedPart& part, const Coord& origin, double halfWidth) {
    constexpr int kEdge = int(Leaf::DIM);
    if (std::abs(part(centre(origin, kEdge))) > halfWidth + PerforatedPart::kSlope * reach(kEdge))
        return nullptr;
    const auto w = static_cast<float>(halfWidth);
    auto leaf = std::make_unique<Leaf>(origin, w, false);
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
        const auto value = static_cast<float>(part(leaf->offsetToGlobalCoord(i).asVec3d()));
        if (std::abs(value) < w)
            leaf->setValueOn(i, value);
        else
            leaf->setValueOff(i, value < 0 ? -w : w);
    }
    return leaf->isEmpty() ? nullptr : std::move(leaf);
}

// 128^3 lattice points.
void sampleRegion(const PerforatedPart& part, double halfWidth, Lower& region) {
    const auto w = static_cast<float>(halfWidth);
    for (openvdb::Index n = 0; n < Lower::NUM_VALUES; ++n) {
        const Coord origin = region.offsetToGlobalCoord(n);
        if (auto leaf = sampleLeaf(part, origin, halfWidth))
            region.addChild(leaf.release());
        else if (part(centre(origin, int(Leaf::DIM))) < 0)
            region.addTile(1, origin, -w, false);
    }
}

}  // namespace

PerforatedPart::PerforatedPart(int voxels) : voxels_(voxels), unit_(voxels / 256.0) {}

double PerforatedPart::operator()(const Vec3d& point) const {
    const Vec3d p = point / unit_ - Vec3d(128.3, 127.7, 128.1);
    constexpr double c = 0.8, s = 0.6;  // a rotation about z, then one about x
    const Vec3d q(c * p[0] - s * p[1], c * (s * p[0] + c * p[1]) - s * p[2],
                  s * (s * p[0] + c * p[1]) + c * p[2]);
    constexpr double k = 2 * M_PI / 40;
    const Vec3d sine(std::sin(k * q[0]), std::sin(k * q[1]), std::sin(k * q[2]));
    const Vec3d cosine(std::cos(k * q[0]), std::cos(k * q[1]), std::cos(k * q[2]));
    const double gyroid = sine[0] * cosine[1] + sine[1] * cosine[2] + sine[2] * cosine[0];
    return unit_ * std::max(p.length() - 110, gyroid / (1.5 * k));
}

openvdb::FloatGrid::Ptr sparseDistance(const PerforatedPart& part, double halfWidth) {
    std::vector<std::unique_ptr<Lower>> regions;
    for (int x = 0; x < part.voxels(); x += int(Lower::DIM))
        for (int y = 0; y < part.voxels(); y += int(Lower::DIM))
            for (int z = 0; z < part.voxels(); z += int(Lower::DIM))
                regions.push_back(std::make_unique<Lower>(Coord(x, y, z), static_cast<float>(halfWidth)));
    tbb::parallel_for(std::size_t(0), regions.size(),
                      [&](std::size_t i) { sampleRegion(part, halfWidth, *regions[i]); });

    auto grid = openvdb::FloatGrid::create(static_cast<float>(halfWidth));
    grid->setName("part");
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    for (auto& region : regions) {
        const Coord origin = region->origin();
        grid->tree().touchLeaf(
            origin);  // makes the nodes above; the region then takes the place of the one below
        grid->tree().root().probeNode<Upper>(origin)->addChild(region.release());
    }
    return grid;
}

}  // namespace isowave::bench
