#include "wavelets/exact.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <atomic>
#include <bit>

#include "volume/leaf_words.h"

namespace isowave::wavelets {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

bool sameBits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

// Turns off what is no different from `found`, and leaves of which nothing is left. What is off is 0: files keep one such value.
void keepDifferent(openvdb::FloatTree& wanted, const openvdb::FloatTree& found) {
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(wanted);
    leaves.foreach ([&found](Leaf& leaf, std::size_t) {
        const Leaf* there = found.probeConstLeaf(leaf.origin());
        for (openvdb::Index n = 0; n < Leaf::SIZE; ++n)
            if (!leaf.isValueOn(n) || (there && sameBits(leaf.getValue(n), there->getValue(n))))
                leaf.setValueOff(n, 0.0f);
    });
    std::vector<openvdb::Coord> empty;
    for (auto leaf = wanted.cbeginLeaf(); leaf; ++leaf)
        if (leaf->isEmpty()) empty.push_back(leaf->origin());
    for (const openvdb::Coord& origin : empty) wanted.addTile(1, origin, 0.0f, false);
}

}  // namespace

openvdb::FloatGrid::Ptr missedOf(const BSplineField& wanted, const BSplineField& found) {
    auto missed = openvdb::FloatGrid::create(0.0f);
    missed->setTree(std::make_shared<openvdb::FloatTree>(wanted.controlPoints->constTree()));
    missed->tree().root().setBackground(0.0f, true);
    missed->setTransform(wanted.transform().copy());
    keepDifferent(missed->tree(), found.controlPoints->constTree());
    return missed->activeVoxelCount() > 0 ? missed : nullptr;
}

void restore(const openvdb::FloatGrid& missed, BSplineField& found) {
    for (auto leaf = missed.constTree().cbeginLeaf(); leaf; ++leaf) {
        Leaf* there = found.controlPoints->tree().probeLeaf(leaf->origin());
        if (!there) continue;
        for (auto value = leaf->cbeginValueOn(); value; ++value)
            if (there->isValueOn(value.pos())) there->setValueOnly(value.pos(), *value);
    }
}

bool areSame(const BSplineField& a, const BSplineField& b) {
    if (a.K != b.K || a.transform() != b.transform() ||
        !a.controlPoints->constTree().hasSameTopology(b.controlPoints->constTree()))
        return false;
    std::atomic<bool> same{true};
    openvdb::tree::LeafManager<const openvdb::FloatTree> leaves(a.controlPoints->constTree());
    leaves.foreach ([&](const Leaf& leaf, std::size_t) {
        const Leaf* other = b.controlPoints->constTree().probeConstLeaf(leaf.origin());
        const auto* inside = a.shape->constTree().probeConstLeaf(leaf.origin());
        const auto* otherInside = b.shape->constTree().probeConstLeaf(leaf.origin());
        if (!other || !inside || !otherInside || insideWordsOf(*inside) != insideWordsOf(*otherInside) ||
            !std::equal(leaf.buffer().data(), leaf.buffer().data() + Leaf::SIZE, other->buffer().data(),
                        sameBits))
            same = false;
    });
    return same;
}

}  // namespace isowave::wavelets
