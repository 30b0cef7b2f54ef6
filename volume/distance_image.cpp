#include "volume/distance_image.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "isowave/error.h"
#include "volume/blocks.h"
#include "volume/distance/crossing_band.h"
#include "volume/distance/image_samples.h"
#include "volume/linear_transform.h"
#include "volume/nodes.h"
#include "volume/nodes_image.h"
#include "volume/padded_leaf.h"
#include "volume/tiles.h"

namespace isowave {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

template <class Tree>
using ConstAccessor = openvdb::tree::ValueAccessor<const Tree>;

// leaf(i, maker): fills and makes the i-th one.
template <class MakeLeaf>
void makeLeaves(std::size_t begin, std::size_t end, double halfWidth, const Progress& progress,
                const MakeLeaf& leaf) {
    tbb::enumerable_thread_specific<LeafMaker> makers([&] { return LeafMaker(halfWidth); });
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, 8), [&](const auto& range) {
        progress.check();
        LeafMaker& maker = makers.local();
        for (std::size_t i = range.begin(); i < range.end(); ++i) leaf(i, maker);
    });
}

// iso - value, positive inside. A point on the iso value is outside, as of an image.
void gather(const openvdb::FloatTree& levelSet, float iso, const openvdb::Coord& origin,
            LeafSamples& samples) {
    constexpr int kBefore = LeafSamples::kBefore;
    PaddedLeaf<float, kBefore, kBefore> values;
    values.gather(ConstAccessor<openvdb::FloatTree>(levelSet), origin);
    static_assert(sizeof values.values == sizeof samples.values);
    std::transform(values.values.begin(), values.values.end(), &samples.values[0][0][0], [iso](float value) {
        return value == iso ? -std::numeric_limits<float>::min() : iso - value;
    });
}

}  // namespace

openvdb::FloatGrid::Ptr distanceFromImage(ImageStream& stream, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress,
                                          const std::function<void(std::int64_t points)>& allow) {
    const NodeCollection nodes = nodesFromImage(stream, solid, progress);
    const std::vector<openvdb::Coord> origins = leavesWithin(nodes, CrossingDistances::kReach);
    if (allow) allow(static_cast<std::int64_t>(origins.size()) * FloatLeaf::SIZE);
    std::vector<FloatLeafPtr> leaves(origins.size());
    ImageSamples image(stream.header(), solid);
    std::size_t made = 0;
    const auto makeThoseBefore = [&](std::int64_t z) {
        const std::size_t begin = made;
        while (made < origins.size() && image.sufficeFor(origins[made], z)) ++made;
        makeLeaves(begin, made, halfWidth, progress, [&](std::size_t i, LeafMaker& maker) {
            image.gather(origins[i], maker.samples());
            leaves[i] = maker.make(origins[i], true);
        });
        if (made < origins.size()) image.forgetBefore(origins[made]);
    };
    if (!origins.empty())
        stream.pass(
            "distances", progress, [&](const Slab& slab) { image.keep(slab); }, makeThoseBefore);
    auto result = bandGrid(std::move(leaves), nodes, halfWidth);
    result->setTransform(linearTransform(stream.header().indexToWorld, "image"));
    return result;
}

openvdb::FloatGrid::Ptr distanceFromImage(const Image& image, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress) {
    ImageStream stream(image);
    return distanceFromImage(stream, solid, halfWidth, progress);
}

openvdb::FloatGrid::Ptr distanceFromLevelSet(const openvdb::FloatGrid& levelSet, double iso, double halfWidth,
                                             const Progress& progress) {
    const openvdb::FloatTree& tree = levelSet.constTree();
    const auto isoValue = static_cast<float>(iso);
    auto inside = openvdb::BoolGrid::create(levelSet.background() < isoValue);
    if (levelSet.background() < isoValue)
        throw InputError(
            levelSet.getName().empty() ? "level set" : levelSet.getName(),
            "the background lies inside (below the iso value), so the solid is unbounded; a level set is "
            "positive outside: use --invert if yours is the other way round");
    inside->setTree(std::make_shared<openvdb::BoolTree>(tree, false, openvdb::TopologyCopy()));
    openvdb::tree::LeafManager<openvdb::BoolTree> leaves(inside->tree());
    leaves.foreach ([&](openvdb::BoolTree::LeafNodeType& leaf, std::size_t) {
        const FloatLeaf* values = tree.probeConstLeaf(leaf.origin());
        for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i)
            leaf.setValueOnly(i, values->getValue(i) < isoValue);
    });
    const auto insideAt = [&] {
        return [accessor = ConstAccessor<openvdb::FloatTree>(tree), isoValue](const openvdb::Coord& c) {
            return accessor.getValue(c) < isoValue;
        };
    };
    fillTiles(inside->tree(), insideAt);
    fillRootTiles(
        inside->tree(), tree, [](const openvdb::Coord& c) { return c; }, insideAt);
    const NodeCollection nodes = nodesFromSigns(*inside);
    progress("distances", 0);
    const std::vector<openvdb::Coord> origins = leavesWithin(nodes, CrossingDistances::kReach);
    std::vector<FloatLeafPtr> made(origins.size());
    makeLeaves(0, origins.size(), halfWidth, progress, [&](std::size_t i, LeafMaker& maker) {
        gather(tree, isoValue, origins[i], maker.samples());
        made[i] = maker.make(origins[i], false);
    });
    auto result = bandGrid(std::move(made), nodes, halfWidth);
    progress("distances", 1);
    result->setTransform(levelSet.transform().copy());
    return result;
}

openvdb::FloatGrid::Ptr distanceFromFunction(const std::function<double(const openvdb::Vec3d&)>& f,
                                             const openvdb::CoordBBox& box, double halfWidth) {
    const auto w = static_cast<float>(halfWidth);
    auto grid = openvdb::FloatGrid::create(w);
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    struct Block {
        std::unique_ptr<FloatLeaf> leaf;
        bool inside = false;
    };
    const auto none = [] { return 0; };
    forEachBlock<Block>(
        box, {}, "sampling",
        [&](const openvdb::Coord& origin, int) {
            Block block{std::make_unique<FloatLeaf>(origin, w, false), false};
            int below = 0, near = 0;
            for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i) {
                const openvdb::Coord c = block.leaf->offsetToGlobalCoord(i);
                const double d =
                    box.isInside(c) ? std::clamp(f(c.asVec3d()), -halfWidth, halfWidth) : halfWidth;
                block.leaf->setValueOnly(i, static_cast<float>(d));
                const bool active = std::abs(static_cast<float>(d)) < w;
                block.leaf->setActiveState(i, active);
                below += d < 0;
                near += active;
            }
            block.inside = below > 0;
            if (near == 0 && (below == 0 || below == static_cast<int>(FloatLeaf::SIZE))) block.leaf.reset();
            return block;
        },
        none,
        [&](const openvdb::Coord& origin, Block& block) {
            if (block.leaf)
                grid->tree().addLeaf(block.leaf.release());
            else if (block.inside)
                grid->tree().addTile(1, origin, -w, false);
        });
    grid->tree().prune();
    return grid;
}

}  // namespace isowave
