#include "volume/distance_image.h"

#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

#include "isowave/error.h"
#include "volume/blocks.h"
#include "volume/linear_transform.h"
#include "volume/nodes.h"
#include "volume/nodes_image.h"
#include "volume/tiles.h"

namespace isowave {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using openvdb::tools::NN_FACE_EDGE_VERTEX;

template <class Tree>
using ConstAccessor = openvdb::tree::ValueAccessor<const Tree>;

// Lattice points within `reach` voxels (in the maximum norm) of a node whose corner signs differ.
openvdb::MaskTree bandAround(const NodeCollection& nodes, int reach) {
    openvdb::MaskTree band(nodes.grid->constTree(), false, openvdb::TopologyCopy());
    openvdb::tools::dilateActiveValues(band, reach + 1, NN_FACE_EDGE_VERTEX, openvdb::tools::EXPAND_TILES);
    band.voxelizeActiveTiles();
    return band;
}

// A lattice point on the iso value is outside. The sweep would take it for inside, and put a surface around
// one that no inside point is beside; the smallest number below zero it takes as meant, and as distance 0
// where an inside point is next to it.
float strictlySigned(float excess) { return excess == 0 ? -std::numeric_limits<float>::min() : excess; }

// What the sweep is given. It tells steep from flat by absolute numbers, so that values of 1e-30 lost where between two lattice
// points the surface is, and a ball 5 % of its volume. A power of two brings the largest to 1 or more: nothing else changes.
void makeSweepable(openvdb::FloatTree& excess) {
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(excess);
    std::vector<float> largest(leaves.leafCount());
    leaves.foreach ([&largest](const FloatLeaf& leaf, std::size_t n) {
        for (auto value = leaf.cbeginValueOn(); value; ++value)
            largest[n] = std::max(largest[n], std::abs(*value));
    });
    const float most = *std::max_element(largest.begin(), largest.end());
    const double scale = most > 0 && most < 1 ? std::ldexp(1.0, -std::ilogb(most)) : 1;
    leaves.foreach ([scale](FloatLeaf& leaf, std::size_t) {
        for (auto value = leaf.beginValueOn(); value; ++value)
            value.setValue(strictlySigned(static_cast<float>(scale * double(*value))));
    });
}

// Distances of the band's lattice points, in voxels, to the zero set of `excess` (value - iso: positive
// inside), whose sign is that of `signs`; clamped to ±halfWidth; every other place ±halfWidth. sweep:
// FastSweeping puts the points beside the surface at 1/sqrt(sum 1/d_a^2), d_a the distance to the crossing
// along axis a (exact for planes), and solves |grad| = 1 away from them.
openvdb::FloatGrid::Ptr sweepBand(openvdb::FloatGrid::Ptr excess, const NodeCollection& signs,
                                  double halfWidth, const Progress& progress) {
    progress("distances", 0.3);
    if (excess->tree().leafCount() > 0) makeSweepable(excess->tree());
    auto distance = openvdb::tools::fogToSdf(*excess, 0.0f);
    excess.reset();
    progress("distances", 0.8);
    const auto w = static_cast<float>(halfWidth);
    auto result = openvdb::FloatGrid::create(w);
    result->setGridClass(openvdb::GRID_LEVEL_SET);
    if (!distance) return result;  // no crossing
    result->setTree(distance->treePtr());
    distance.reset();
    const openvdb::BoolTree& inside = signs.grid->constTree();
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(result->tree());
    leaves.foreach ([&inside, w](FloatLeaf& leaf, std::size_t) {
        ConstAccessor<openvdb::BoolTree> accessor(inside);
        for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i) {
            const float d = leaf.isValueOn(i) ? std::min(std::abs(leaf.getValue(i)), w) : w;
            // A point on the surface itself counts as outside, at +0.
            leaf.setValueOnly(i, accessor.getValue(leaf.offsetToGlobalCoord(i)) ? -std::max(d, 1e-6f) : d);
            leaf.setActiveState(i, d < w);
        }
    });
    result->tree().root().setBackground(w, false);
    const auto valueAt = [&inside, w] {
        return [accessor = ConstAccessor<openvdb::BoolTree>(inside), w](const openvdb::Coord& c) {
            return accessor.getValue(c) ? -w : w;
        };
    };
    fillTiles(result->tree(), valueAt);
    fillRootTiles(
        result->tree(), inside, [](const openvdb::Coord& c) { return c; }, valueAt);
    progress("distances", 1);
    return result;
}

// A grid on the band, whose values are still to be set.
openvdb::FloatGrid::Ptr bandGrid(const openvdb::MaskTree& band) {
    auto grid = openvdb::FloatGrid::create(-1.0f);
    grid->setTree(std::make_shared<openvdb::FloatTree>(band, -1.0f, openvdb::TopologyCopy()));
    return grid;
}

// Tiles beside the band: +-1 by sign, or the sweep would see a surface between the band and a tile of the
// wrong sign.
void fillBeside(openvdb::FloatTree& band, const NodeCollection& nodes) {
    const openvdb::BoolTree& inside = nodes.grid->constTree();
    const auto signAt = [&inside] {
        return [accessor = ConstAccessor<openvdb::BoolTree>(inside)](const openvdb::Coord& c) {
            return accessor.getValue(c) ? 1.0f : -1.0f;
        };
    };
    fillTiles(band, signAt);
    fillRootTiles(
        band, inside, [](const openvdb::Coord& c) { return c; }, signAt);
}

int reachOf(double halfWidth) { return static_cast<int>(std::ceil(halfWidth)) + 1; }

}  // namespace

namespace {

// value - iso, positive inside.
class ImageExcess {
  public:
    ImageExcess(const Image& image, const ImageSolid& solid)
        : size_(image.size),
          iso_(solid.label ? 0.5 : solid.iso),
          orientation_(solid.invert ? -1 : 1),
          margin_(solid.openBorder ? kOpenBorder : 0) {
        if (solid.label) label_ = static_cast<float>(*solid.label);
    }

    // value: of the nearest voxel.
    float at(const openvdb::Coord& c, float value) const {
        const double excess = orientation_ * ((label_ ? double(value == *label_) : double(value)) - iso_);
        bool beyond = false;
        for (int a = 0; a < 3; ++a) beyond = beyond || c[a] < -margin_ || c[a] >= size_[a] + margin_;
        // The cap: beyond the border the nearest voxel is mirrored at the iso value, so a solid that touches
        // the border ends half a voxel outside it.
        return static_cast<float>(beyond && excess > 0 ? -excess : excess);
    }

  private:
    std::array<std::int64_t, 3> size_;
    double iso_, orientation_;
    int margin_;
    std::optional<float> label_;
};

// The leaves of a band by the slices that their lattice points are nearest to.
class BandLeaves {
  public:
    BandLeaves(openvdb::FloatTree& band, const Image& image) : size_(image.size) {
        std::vector<FloatLeaf*> leaves;
        leaves.reserve(band.leafCount());
        band.getNodes(leaves);
        layers_.resize(static_cast<std::size_t>((size_[2] + 7) / 8));
        for (FloatLeaf* leaf : leaves)
            layers_[static_cast<std::size_t>(nearest(leaf->origin()[2], 2) / 8)].push_back(leaf);
        for (auto& layer : layers_)  // in the order of the voxels
            std::sort(layer.begin(), layer.end(), [](const FloatLeaf* a, const FloatLeaf* b) {
                return std::tuple(a->origin()[1], a->origin()[0]) <
                       std::tuple(b->origin()[1], b->origin()[0]);
            });
    }

    // Different slices write to different voxels: threads may share a leaf.
    void fill(const Slab& slab, const ImageExcess& excess) const {
        std::visit([&](auto voxels) { fillFrom(voxels.data(), slab.z0, slab.z1, excess); }, slab.voxels);
    }

  private:
    std::int64_t nearest(std::int64_t c, std::size_t axis) const {
        return std::clamp<std::int64_t>(c, 0, size_[axis] - 1);
    }

    template <class T>
    void fillFrom(const T* voxels, std::int64_t z0, std::int64_t z1, const ImageExcess& excess) const {
        for (std::int64_t layer = z0 / 8; layer <= (z1 - 1) / 8; ++layer)
            for (FloatLeaf* leaf : layers_[static_cast<std::size_t>(layer)])
                for (int k = 0; k < 8; ++k)
                    if (const std::int64_t z = nearest(leaf->origin()[2] + k, 2); z0 <= z && z < z1)
                        fillSlice(voxels + (z - z0) * size_[0] * size_[1], *leaf, k, excess);
    }

    template <class T>
    void fillSlice(const T* slice, FloatLeaf& leaf, int k, const ImageExcess& excess) const {
        for (int i = 0; i < 8; ++i)
            for (int j = 0; j < 8; ++j) {
                const openvdb::Coord c = leaf.origin().offsetBy(i, j, k);
                const T value = slice[nearest(c[0], 0) + size_[0] * nearest(c[1], 1)];
                leaf.setValueOnly(static_cast<openvdb::Index>(i << 6 | j << 3 | k),
                                  excess.at(c, static_cast<float>(value)));
            }
    }

    std::array<std::int64_t, 3> size_;
    std::vector<std::vector<FloatLeaf*>> layers_;  // of eight slices each
};

}  // namespace

openvdb::FloatGrid::Ptr distanceFromImage(ImageStream& stream, const ImageSolid& solid, double halfWidth,
                                          const Progress& progress,
                                          const std::function<void(std::int64_t)>& allow) {
    const NodeCollection nodes = nodesFromImage(stream, solid, progress);
    const Image& image = stream.header();
    const ImageExcess excess(image, solid);
    auto grid = [&] {
        const openvdb::MaskTree band = bandAround(nodes, reachOf(halfWidth));
        if (allow) allow(static_cast<std::int64_t>(band.activeVoxelCount()));
        return bandGrid(band);
    }();
    if (!grid->empty()) {
        const BandLeaves leaves(grid->tree(), image);
        stream.pass("reading", progress, [&](const Slab& slab) { leaves.fill(slab, excess); });
    }
    fillBeside(grid->tree(), nodes);
    auto result = sweepBand(std::move(grid), nodes, halfWidth, progress);
    result->setTransform(linearTransform(image.indexToWorld, "image"));
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
    auto excess = bandGrid(bandAround(nodes, reachOf(halfWidth)));
    openvdb::tree::LeafManager<openvdb::FloatTree> band(excess->tree());
    band.foreach ([&](FloatLeaf& leaf, std::size_t) {
        const ConstAccessor<openvdb::FloatTree> accessor(tree);
        for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i)
            leaf.setValueOnly(i, isoValue - accessor.getValue(leaf.offsetToGlobalCoord(i)));
    });
    fillBeside(excess->tree(), nodes);
    auto result = sweepBand(std::move(excess), nodes, halfWidth, progress);
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
