#include "volume/walls/feet.h"

#include <openvdb/tree/LeafManager.h>

#include <cmath>

namespace isowave {
namespace {

using openvdb::Vec3d;
using MaskLeaf = openvdb::MaskTree::LeafNodeType;

// How far the distance to the nearest triangle may be from the grid's, in voxels: far above float32's
// rounding, far below what is lifted beside buried surface.
constexpr double kSameDistance = 1e-3;

// x lies on the plane of a triangle where its height is less than this share of its distance.
constexpr double kOnPlane = 1e-3;

Foot footOf(const Vec3d& x, float distance, const TriangleHierarchy& triangles,
            TriangleHierarchy::Nearest& bound) {
    const double reach = std::abs(distance) + kSameDistance;
    if (bound.triangle >= 0) bound = triangles.distanceTo(bound.triangle, x);
    if (bound.triangle < 0 || bound.squared > reach * reach) bound = {reach * reach, -1};
    bound = triangles.nearest(x, bound);
    if (bound.triangle < 0 || std::abs(distance) - std::sqrt(bound.squared) > kSameDistance) return {};
    const Vec3d foot = triangles.footOn(bound.triangle, x), off = x - foot;
    Vec3d normal = triangles.areaNormal(bound.triangle);
    if (!normal.normalize()) return {};
    const double height = normal.dot(off);
    if (std::abs(height) > kOnPlane * off.length() && (height < 0) != (distance < 0)) normal = -normal;
    return {openvdb::Vec3f(foot), openvdb::Vec3f(normal), distance};
}

}  // namespace

Feet::Feet(const openvdb::MaskTree& mask, const openvdb::FloatTree& distance,
           const TriangleHierarchy& triangles, double farthest, const Progress& progress)
    : mask_(mask) {
    openvdb::tree::LeafManager<openvdb::MaskTree> leaves(mask_);
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < leaves.leafCount(); ++i) {
        leaves.leaf(i).setTransientData(static_cast<openvdb::Index32>(i));
        first_.push_back(count);
        count += static_cast<std::uint32_t>(leaves.leaf(i).onVoxelCount());
    }
    feet_.resize(count);
    leaves.foreach ([&](MaskLeaf& leaf, std::size_t i) {
        progress.check();
        openvdb::tree::ValueAccessor<const openvdb::FloatTree> values(distance);
        const auto* here = values.probeConstLeaf(leaf.origin());
        TriangleHierarchy::Nearest near{0, -1};
        std::uint32_t n = first_[i];
        for (auto point = leaf.cbeginValueOn(); point; ++point, ++n) {
            const float value = here ? here->getValue(point.pos()) : values.getValue(point.getCoord());
            if (std::abs(value) <= farthest)
                feet_[n] = footOf(point.getCoord().asVec3d(), value, triangles, near);
        }
    });
}

}  // namespace isowave
