// Block by block of 8^3 lattice points: weights -> values.
#include "lod/regions/fade.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "polygonize/knot_insertion.h"

namespace isowave::lod {
namespace {

using openvdb::Coord;
using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr int kSide = Leaf::DIM;

openvdb::Vec3d axisOf(const openvdb::math::Transform& lattice, int axis) {
    Coord step(0);
    step[axis] = 1;
    return lattice.indexToWorld(step) - lattice.indexToWorld(Coord(0));
}

double diagonalOf(const openvdb::math::Transform& lattice) {
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis) squared += axisOf(lattice, axis).lengthSqr();
    return std::sqrt(squared);
}

// What one block becomes.
struct Block {
    bool changed = false;        // of the coarse field's
    std::unique_ptr<Leaf> leaf;  // null: all points have the value `tile` and are not known
    float tile = 0;
    std::unique_ptr<Leaf> weights;  // null: all points have `weight`
    float weight = 0;
    bool weighed = false;
    std::int64_t finePoints = 0;
    bool hasInside = false, hasOutside = false;  // of the control points of both fields where w > 0

    void see(float value) { (value < 0 ? hasInside : hasOutside) = true; }
};

class Blender {
  public:
    Blender(const BSplineField& coarse, const BSplineField& fine, const Fade& fade)
        : fade_(fade),
          coarse_(coarse.controlPoints->tree()),
          fine_(fine.controlPoints->tree()),
          coarseAccessor_(coarse_),
          fineAccessor_(fine_) {}

    Block at(const Coord& origin) const {
        Block block;
        const Leaf* c = coarseAccessor_.probeConstLeaf(origin);
        const Leaf* f = fineAccessor_.probeConstLeaf(origin);
        if (!c && !f && coarseAccessor_.getValue(origin) == fineAccessor_.getValue(origin)) return block;
        block.weighed = true;
        const double weight = fade_.ofBlock(origin);
        if (weight >= 0) {
            block.weight = static_cast<float>(weight);
            if (weight > 0) takeFine(block, origin, c, f);
        } else {
            mix(block, origin, c, f);
        }
        return block;
    }

  private:
    void takeFine(Block& block, const Coord& origin, const Leaf* c, const Leaf* f) const {
        block.changed = true;
        for (openvdb::Index n = 0; n < (c ? Leaf::SIZE : 1); ++n)
            block.see(c ? c->getValue(n) : coarseAccessor_.getValue(origin));
        for (openvdb::Index n = 0; n < (f ? Leaf::SIZE : 1); ++n)
            block.see(f ? f->getValue(n) : fineAccessor_.getValue(origin));
        if (f) {
            block.leaf = std::make_unique<Leaf>(*f);
            block.finePoints = static_cast<std::int64_t>(f->onVoxelCount());
        } else {
            block.tile = fineAccessor_.getValue(origin);
        }
    }

    void mix(Block& block, const Coord& origin, const Leaf* c, const Leaf* f) const {
        const float ofCoarse = coarseAccessor_.getValue(origin), ofFine = fineAccessor_.getValue(origin);
        block.weights = std::make_unique<Leaf>(origin, 0.0f, true);
        auto leaf = c ? std::make_unique<Leaf>(*c) : std::make_unique<Leaf>(origin, ofCoarse, false);
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
            const auto w = static_cast<float>(fade_.at(origin + Leaf::offsetToLocalCoord(n)));
            block.weights->setValueOnly(n, w);
            if (w <= 0) continue;
            const float coarse = c ? c->getValue(n) : ofCoarse, fine = f ? f->getValue(n) : ofFine;
            const bool fineKnown = f && f->isValueOn(n), coarseKnown = c && c->isValueOn(n);
            block.finePoints += fineKnown;
            block.changed = block.changed || coarse != fine;
            block.see(coarse), block.see(fine);
            leaf->setValueOnly(n, w >= 1 || coarse == fine
                                      ? fine
                                      : static_cast<float>(double(w) * fine + (1 - double(w)) * coarse));
            leaf->setActiveState(n, fineKnown || (w < 1 && (coarseKnown || coarse != fine)));
        }
        block.leaf = std::move(leaf);
    }

    const Fade& fade_;
    const openvdb::FloatTree &coarse_, &fine_;
    openvdb::FloatGrid::ConstUnsafeAccessor coarseAccessor_, fineAccessor_;
};

// The blocks in which a weight may be above 0 and something may be stored.
std::vector<Coord> blocksOf(const openvdb::CoordBBox& fading, const openvdb::FloatTree& coarse,
                            const openvdb::FloatTree& fine) {
    openvdb::CoordBBox box, other;
    coarse.evalLeafBoundingBox(box);
    fine.evalLeafBoundingBox(other);
    box.expand(other);
    box.intersect(fading);
    std::vector<Coord> origins;
    if (box.empty()) return origins;
    const Coord low = box.min() & ~(kSide - 1);
    for (int x = low.x(); x <= box.max().x(); x += kSide)
        for (int y = low.y(); y <= box.max().y(); y += kSide)
            for (int z = low.z(); z <= box.max().z(); z += kSide) origins.emplace_back(x, y, z);
    return origins;
}

void put(std::vector<Block>& blocks, const std::vector<Coord>& origins, openvdb::FloatTree& field,
         openvdb::FloatTree& weights, Blend& result) {
    bool changed = false, hasInside = false, hasOutside = false;
    openvdb::tree::ValueAccessor<openvdb::FloatTree> values(field), known(weights);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        Block& block = blocks[i];
        result.finePoints += block.finePoints;
        changed = changed || block.changed;
        hasInside = hasInside || block.hasInside;
        hasOutside = hasOutside || block.hasOutside;
        if (block.weights)
            known.addLeaf(block.weights.release());
        else if (block.weighed)
            known.addTile(1, origins[i], block.weight, true);
        if (!block.changed) continue;
        if (block.leaf)
            values.addLeaf(block.leaf.release());
        else
            values.addTile(1, origins[i], block.tile, false);
    }
    result.differs = changed && hasInside && hasOutside;
}

}  // namespace

double marginOn(const openvdb::math::Transform& lattice) { return 2 * diagonalOf(lattice); }

FadingRegion fading(std::shared_ptr<const RegionDistance> region, const openvdb::math::Transform& lattice,
                    double width) {
    return {std::move(region), marginOn(lattice), width};
}

Fade::Fade(std::vector<FadingRegion> regions, const openvdb::math::Transform& lattice)
    : regions_(std::move(regions)), blockReach_(0) {
    for (int axis = 0; axis < 3; ++axis) blockReach_ += kSide / 2 * axisOf(lattice, axis).length();
}

double Fade::at(const Coord& point) const {
    double largest = 0;
    for (const auto& [region, margin, width] : regions_) {
        const double distance = region->at(point, margin + width);
        const double t = std::clamp(1 - (distance - margin) / width, 0.0, 1.0);
        largest = std::max(largest, t * t * (3 - 2 * t));
    }
    return largest;
}

double Fade::ofBlock(const Coord& origin) const {
    double weight = 0;
    for (const auto& [region, margin, width] : regions_) {
        const double reach = margin + width;
        const double distance = region->at(origin.offsetBy(kSide / 2), reach + blockReach_);
        if (distance + blockReach_ <= margin) return 1;
        if (distance - blockReach_ < reach) weight = -1;
    }
    return weight;
}

openvdb::CoordBBox Fade::box() const {
    openvdb::CoordBBox box;
    for (const auto& [region, margin, width] : regions_) box.expand(region->boxWithin(margin + width));
    return box;
}

FadeWeights::FadeWeights(Fade fade, const openvdb::math::Transform& lattice)
    : fade_(std::move(fade)), lattice_(lattice.copy()), box_(fade_.box()), known_(0.0f) {}

double FadeWeights::Reader::at(const Coord& point) const {
    float weight = 0;
    return accessor_.probeValue(point, weight) ? double(weight) : weights_->fade_.at(point);
}

FadeWeights::Range FadeWeights::Reader::around(const Point& place) const {
    const openvdb::Vec3d index =
        weights_->lattice_->worldToIndex(openvdb::Vec3d(place[0], place[1], place[2]));
    const Coord low = Coord::floor(index).offsetBy(-1), high = low.offsetBy(3);
    if (!weights_->box_.hasOverlap({low, high})) return {};
    Range range{1, 0};
    for (int x = low.x(); x <= high.x(); ++x)
        for (int y = low.y(); y <= high.y(); ++y)
            for (int z = low.z(); z <= high.z(); ++z) {
                const double w = at({x, y, z});
                range.least = std::min(range.least, w);
                range.most = std::max(range.most, w);
            }
    return range;
}

Blend blend(const BSplineField& coarse, const BSplineField& fine, FadeWeights& weights,
            const Progress& progress) {
    const std::vector<Coord> origins =
        blocksOf(weights.fade().box(), coarse.controlPoints->tree(), fine.controlPoints->tree());
    std::vector<Block> blocks(origins.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, origins.size(), 16), [&](const auto& range) {
        progress.check();
        const Blender blender(coarse, fine, weights.fade());
        for (std::size_t i = range.begin(); i != range.end(); ++i) blocks[i] = blender.at(origins[i]);
    });
    Blend result;
    result.field = coarse;
    result.field.controlPoints = coarse.controlPoints->deepCopy();
    put(blocks, origins, result.field.controlPoints->tree(), weights.known(), result);
    result.field.shape = shapeOf(*result.field.controlPoints, progress);
    result.field.shape->setName(coarse.shape->getName());
    return result;
}

}  // namespace isowave::lod
