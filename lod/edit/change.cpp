#include "lod/edit/change.h"

#include <openvdb/tools/Morphology.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "volume/fit/known.h"
#include "volume/leaf_words.h"
#include "volume/padded_leaf.h"

namespace isowave::lod {
namespace {

using openvdb::Coord;
using Floats = openvdb::FloatTree;
using FloatLeaf = Floats::LeafNodeType;
using BoolLeaf = openvdb::BoolTree::LeafNodeType;
using Mask = openvdb::MaskTree;
using MaskLeaf = Mask::LeafNodeType;

template <class Tree>
using ConstAccessor = openvdb::tree::ValueAccessor<const Tree, false>;

// |F| of so much of K counts as K: what wavelets leave of a plateau.
constexpr double kPlateau = 1 - 1e-5;

bool sameBits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

template <class Tree>
void touchLeaves(Tree& tree, const Mask& mask) {
    openvdb::tree::ValueAccessor<Tree> accessor(tree);
    for (auto leaf = mask.cbeginLeaf(); leaf; ++leaf) accessor.touchLeaf(leaf->origin());
}

// Leaves without known points whose values are all one become tiles.
template <class Tree>
void dropEmptyLeaves(Tree& tree) {
    std::vector<std::pair<Coord, typename Tree::ValueType>> empty;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        if (!leaf->isEmpty()) continue;
        const auto first = leaf->getValue(0);
        bool one = true;
        for (openvdb::Index n = 1; one && n < FloatLeaf::SIZE; ++n) one = leaf->getValue(n) == first;
        if (one) empty.emplace_back(leaf->origin(), first);
    }
    for (const auto& [origin, value] : empty) tree.addTile(1, origin, value, false);
}

class Application {
  public:
    Application(const BSplineField& field, const Change& change, double nearest)
        : old_(field),
          change_(change),
          near_(nearest * field.K),
          c_(std::make_shared<Floats>(field.controlPoints->constTree())) {}

    Changed run() {
        putControlPoints();
        sample();
        const Mask known = fitting::knownAround(nodes());
        Changed result;
        result.field = settled(known, result);
        return result;
    }

  private:
    void putControlPoints() {
        openvdb::tree::ValueAccessor<Floats> to(*c_);
        for (auto leaf = change_.controlPoints.cbeginLeaf(); leaf; ++leaf) {
            FloatLeaf* there = to.touchLeaf(leaf->origin());
            for (auto value = leaf->cbeginValueOn(); value; ++value) there->setValueOnly(value.pos(), *value);
        }
        for (const Coord& origin : change_.filled) c_->addTile(1, origin, change_.fill, false);
    }

    // S, and F' around it.
    void sample() {
        seen_.reset(new Mask(dilated(Mask(change_.controlPoints, false, openvdb::TopologyCopy()), 1)));
        for (const Coord& origin : change_.filled) seen_->addTile(1, origin, false, false);
        const Mask around = dilated(*seen_, 2);
        touchLeaves(F_, around);
        openvdb::tree::LeafManager<Floats> leaves(F_);
        leaves.foreach ([&](FloatLeaf& leaf, std::size_t) {
            const std::array<double, 512> values = valuesOf(*c_, leaf.origin());
            for (openvdb::Index n = 0; n < FloatLeaf::SIZE; ++n)
                leaf.setValueOnly(n, static_cast<float>(values[n]));
        });
    }

    Mask nodes() const {
        Mask nodes = definedNodes(old_);
        nodes.voxelizeActiveTiles();
        for (const Coord& origin : change_.filled) nodes.addTile(1, origin, false, false);
        const Mask around = dilated(*seen_, 1);
        touchLeaves(nodes, around);
        openvdb::tree::LeafManager<Mask> leaves(nodes);
        leaves.foreach ([&](MaskLeaf& leaf, std::size_t) {
            if (around.probeConstLeaf(leaf.origin())) choose(leaf);
        });
        return nodes;
    }

    void choose(MaskLeaf& nodes) const {
        PaddedLeaf<float, 0, 1> F;
        PaddedLeaf<bool, 0, 1> seen;
        F.gather(ConstAccessor<Floats>(F_), nodes.origin());
        seen.gather(ConstAccessor<Mask>(*seen_), nodes.origin(),
                    [](const MaskLeaf& leaf, openvdb::Index n) { return leaf.isValueOn(n); });
        for (openvdb::Index n = 0; n < MaskLeaf::SIZE; ++n) {
            const Coord at = MaskLeaf::offsetToLocalCoord(n);
            bool anySeen = false, inside = false, outside = false;
            double least = HUGE_VAL;
            for (int b = 0; b < 8; ++b) {
                const int x = at.x() + (b >> 2), y = at.y() + (b >> 1 & 1), z = at.z() + (b & 1);
                anySeen = anySeen || seen.at(x, y, z);
                const float value = F.at(x, y, z);
                (value < 0 ? inside : outside) = true;
                least = std::min(least, double(std::abs(value)));
            }
            if (!anySeen) continue;
            const bool keep =
                (inside && outside) || least < near_ || (nodes.isValueOn(n) && least < kPlateau * old_.K);
            nodes.setActiveState(n, keep);
        }
    }

    // known: I'. What is not in it becomes K by its sign.
    BSplineField settled(const Mask& known, Changed& counts) {
        BSplineField field;
        field.K = old_.K;
        field.shape = old_.shape->deepCopy();
        openvdb::BoolTree& shape = field.shape->tree();
        for (const Coord& origin : change_.filled) shape.addTile(1, origin, change_.fill < 0, false);
        for (const Mask* mask : {&known, static_cast<const Mask*>(seen_.get())}) {
            touchLeaves(shape, *mask);
            touchLeaves(*c_, *mask);
        }
        openvdb::tree::LeafManager<openvdb::BoolTree>(shape).foreach (
            [&](BoolLeaf& leaf, std::size_t) { settle(leaf, known); });
        openvdb::tree::LeafManager<Floats>(*c_).foreach (
            [&](FloatLeaf& leaf, std::size_t) { settle(leaf, known, shape); });
        count(known, counts);
        dropEmptyLeaves(shape);
        dropEmptyLeaves(*c_);
        field.controlPoints = openvdb::FloatGrid::create(c_);
        field.controlPoints->setTransform(old_.transform().copy());
        field.controlPoints->setName("field");
        return field;
    }

    static LeafWords knownWords(const Mask& known, const Coord& origin) {
        const MaskLeaf* leaf = known.probeConstLeaf(origin);
        return leaf ? wordsOf(leaf->getValueMask()) : LeafWords{};
    }

    void settle(BoolLeaf& leaf, const Mask& known) const {
        if (const MaskLeaf* seen = seen_->probeConstLeaf(leaf.origin())) {
            const FloatLeaf& F = *F_.probeConstLeaf(leaf.origin());
            const LeafWords at = wordsOf(seen->getValueMask()), negative = negativeWordsOf(F.buffer().data());
            LeafWords inside = insideWordsOf(leaf);
            for (std::size_t x = 0; x < inside.size(); ++x)
                inside[x] = (inside[x] & ~at[x]) | (negative[x] & at[x]);
            setInside(leaf, inside);
        }
        leaf.setValueMask(maskOf(knownWords(known, leaf.origin())));
    }

    void settle(FloatLeaf& leaf, const Mask& known, const openvdb::BoolTree& shape) const {
        const LeafWords now = knownWords(known, leaf.origin());
        const BoolLeaf* signs = shape.probeConstLeaf(leaf.origin());
        const LeafWords inside = signs ? insideWordsOf(*signs) : LeafWords{};
        const auto K = static_cast<float>(old_.K);
        for (openvdb::Index n = 0; n < FloatLeaf::SIZE; ++n)
            if (!(now[n >> 6] >> (n & 63) & 1) && signs)
                leaf.setValueOnly(n, inside[n >> 6] >> (n & 63) & 1 ? -K : K);
        leaf.setValueMask(maskOf(now));
    }

    void count(const Mask& known, Changed& counts) const {
        const Floats& before = old_.controlPoints->constTree();
        Mask either(before, false, openvdb::TopologyCopy());
        either.topologyUnion(known);
        const ConstAccessor<Floats> was(before), is(*c_);
        for (auto leaf = either.cbeginLeaf(); leaf; ++leaf)
            for (auto point = leaf->cbeginValueOn(); point; ++point) {
                float a = 0, b = 0;
                const bool knownBefore = was.probeValue(point.getCoord(), a),
                           knownNow = is.probeValue(point.getCoord(), b);
                counts.touched += !sameBits(a, b);
                counts.known += knownNow && !knownBefore;
                counts.forgotten += knownBefore && !knownNow;
            }
    }

    const BSplineField& old_;
    const Change& change_;
    double near_;
    Floats::Ptr c_;
    std::unique_ptr<Mask> seen_;
    Floats F_{0.0f};
};

}  // namespace

std::array<double, 512> valuesOf(const Floats& controlPoints, const Coord& origin) {
    PaddedLeaf<double, 1, 1> c;
    c.gather(ConstAccessor<Floats>(controlPoints), origin);
    std::array<double, 512> values;
    filterThreeTaps(c, 4.0 / 6, 1.0 / 6, values);
    return values;
}

Mask dilated(const Mask& mask, int by) {
    Mask result(mask);
    openvdb::tools::dilateActiveValues(result, by, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    result.voxelizeActiveTiles();
    return result;
}

Changed apply(const BSplineField& field, const Change& change, double nearest, const Progress& progress) {
    progress.check();
    return Application(field, change, nearest).run();
}

}  // namespace isowave::lod
