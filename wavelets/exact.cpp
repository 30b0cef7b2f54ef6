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

void keepExactly(Pyramid& pyramid, const BSplineField& field, const Progress& progress) {
    pyramid.exact = nullptr;
    const BSplineField found = pyramid.field(0, progress);
    auto wanted = openvdb::FloatGrid::create(0.0f);
    wanted->setTree(std::make_shared<openvdb::FloatTree>(field.controlPoints->constTree()));
    wanted->setTransform(field.transform().copy());
    keepDifferent(wanted->tree(), found.controlPoints->constTree());
    if (wanted->activeVoxelCount() > 0) pyramid.exact = wanted;
}

void restoreExactly(const Pyramid& pyramid, BSplineField& field) {
    if (!pyramid.exact) return;
    for (auto leaf = pyramid.exact->constTree().cbeginLeaf(); leaf; ++leaf) {
        Leaf* there = field.controlPoints->tree().probeLeaf(leaf->origin());
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
