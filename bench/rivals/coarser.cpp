#include "coarser.h"

#include <algorithm>
#include <cmath>

namespace isowave::bench {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

// Lattice points of the level around everything that `fine` holds, and two more: dense, these are small programs.
template <class Tree>
CoordBBox coarseBox(const Tree& fine, int levels) {
    CoordBBox box;
    fine.evalLeafBoundingBox(box);
    return {(box.min() >> levels).offsetBy(-2), (box.max() >> levels).offsetBy(2)};
}

openvdb::math::Transform::Ptr coarseTransform(const openvdb::math::Transform& fine, int levels) {
    auto transform = fine.copy();
    transform->preScale(1 << levels);
    return transform;
}

}  // namespace

NodeCollection prunedCollection(const NodeCollection& finest, int levels) {
    const openvdb::BoolTree& fine = finest.grid->constTree();
    NodeCollection coarse{openvdb::BoolGrid::create(false)};
    coarse.grid->setTransform(coarseTransform(finest.grid->transform(), levels));
    auto to = coarse.grid->getAccessor();
    const auto inside = finest.grid->getConstAccessor();
    const CoordBBox box = coarseBox(fine, levels);
    for (auto c = box.begin(); c; ++c)
        if (inside.getValue(*c << levels)) to.setValueOff(*c, true);
    for (auto node = finest.grid->cbeginValueOn(); node; ++node) {
        const Coord grey = node.getCoord() >> levels;
        to.setValueOn(grey, inside.getValue(grey << levels));
    }
    return coarse;
}

openvdb::FloatGrid::Ptr pooledDistance(const openvdb::FloatGrid& distance, int levels, double halfWidth) {
    const int n = 1 << levels;
    const auto w = static_cast<float>(halfWidth);
    auto coarse = openvdb::FloatGrid::create(w);
    auto transform = coarseTransform(distance.transform(), levels);
    transform->preTranslate(openvdb::Vec3d(0.5 * (n - 1) / n));
    coarse->setTransform(transform);
    auto to = coarse->getAccessor();
    const auto from = distance.getConstAccessor();
    const CoordBBox box = coarseBox(distance.constTree(), levels);
    for (auto c = box.begin(); c; ++c) {
        double sum = 0;
        const CoordBBox block = CoordBBox::createCube(*c << levels, n);
        for (auto fine = block.begin(); fine; ++fine) sum += from.getValue(*fine);
        const auto mean =
            static_cast<float>(std::clamp(sum / (double(n) * n * n * n), -halfWidth, halfWidth));
        if (std::abs(mean) < w)
            to.setValueOn(*c, mean);
        else if (mean < 0)
            to.setValueOff(*c, -w);
    }
    return coarse;
}

}  // namespace isowave::bench
