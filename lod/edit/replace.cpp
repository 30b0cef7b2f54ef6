#include "lod/edit/replace.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "polygonize/knot_insertion.h"

namespace isowave::lod {
namespace {

using openvdb::Coord;
using Floats = openvdb::FloatTree;
using Leaf = Floats::LeafNodeType;

void addInsideTiles(const Floats& tree, const Floats& other, std::set<Coord>& origins) {
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(Floats::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        if (*tile >= 0) continue;
        openvdb::CoordBBox box;
        tile.getBoundingBox(box);
        for (int x = box.min().x(); x <= box.max().x(); x += Leaf::DIM)
            for (int y = box.min().y(); y <= box.max().y(); y += Leaf::DIM)
                for (int z = box.min().z(); z <= box.max().z(); z += Leaf::DIM)
                    if (const Coord at(x, y, z); other.probeConstLeaf(at) || other.getValue(at) != *tile)
                        origins.insert(at);
    }
}

// Leaves in which the two may differ.
std::vector<Coord> leavesOf(const Floats& a, const Floats& b) {
    std::set<Coord> origins;
    for (const Floats* tree : {&a, &b})
        for (auto leaf = tree->cbeginLeaf(); leaf; ++leaf) origins.insert(leaf->origin());
    addInsideTiles(a, b, origins);
    addInsideTiles(b, a, origins);
    return {origins.begin(), origins.end()};
}

double valueAt(const Leaf* leaf, const Floats& tree, const Coord& origin, openvdb::Index n) {
    return leaf ? leaf->getValue(n) : tree.getValue(origin);
}

}  // namespace

Change replaced(const BSplineField& finest, const BSplineField& before, const BSplineField& after,
                const std::array<int, 3>& halvings, const Progress& progress) {
    const BSplineField a = insertKnots(before, halvings, progress),
                       b = insertKnots(after, halvings, progress);
    const Floats &f = finest.controlPoints->constTree(), &c = a.controlPoints->constTree(),
                 &other = b.controlPoints->constTree();
    const std::vector<Coord> origins = leavesOf(c, other);
    std::vector<std::unique_ptr<Leaf>> made(origins.size());
    tbb::parallel_for(std::size_t(0), origins.size(), [&](std::size_t i) {
        const Coord& origin = origins[i];
        const Leaf *ofF = f.probeConstLeaf(origin), *ofC = c.probeConstLeaf(origin),
                   *ofOther = other.probeConstLeaf(origin);
        auto leaf = std::make_unique<Leaf>(origin, 0.0f, false);
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            const double coarse = valueAt(ofC, c, origin, n),
                         moved = valueAt(ofOther, other, origin, n) - coarse;
            if (moved == 0) continue;
            const double t = std::min(1.0, std::abs(moved) / finest.K), gone = t * t * (3 - 2 * t),
                         old = valueAt(ofF, f, origin, n);
            leaf->setValueOn(n, static_cast<float>(old + moved - gone * (old - coarse)));
        }
        if (!leaf->isEmpty()) made[i] = std::move(leaf);
    });
    Change change;
    for (auto& leaf : made)
        if (leaf) change.controlPoints.addLeaf(leaf.release());
    return change;
}

}  // namespace isowave::lod
