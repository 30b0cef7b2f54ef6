#include "volume/parts/field_part.h"

#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cassert>

#include "volume/leaf_words.h"

namespace isowave {
namespace {

using openvdb::BoolTree;
using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::FloatTree;

// Calls put(box) for the inside tiles of a tree, as far as they lie in a box.
template <class Put>
void forEachInsideTile(const BoolTree& tree, const CoordBBox& box, const Put& put) {
    auto tile = tree.cbeginValueAll();
    tile.setMaxDepth(BoolTree::ValueAllCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        if (!*tile) continue;
        CoordBBox inside = tile.getBoundingBox();
        inside.intersect(box);
        if (!inside.empty()) put(inside);
    }
}

// A root's tile reaches further than a coordinate may be moved.
const CoordBBox kEverywhere(Coord(-(1 << 29)), Coord((1 << 29) - 1));

// Copies of the leaves of a tree in a box.
template <class Tree>
void copyLeaves(const Tree& from, const CoordBBox& box, const Coord& shift, Tree& to) {
    openvdb::tree::ValueAccessor<Tree> accessor(to);
    for (auto leaf = from.cbeginLeaf(); leaf; ++leaf) {
        if (!box.isInside(leaf->origin())) continue;
        auto copy = std::make_unique<typename Tree::LeafNodeType>(*leaf);
        copy->setOrigin(leaf->origin() + shift);
        accessor.addLeaf(copy.release());
    }
}

// A tree of these leaves whose slots have the signs of `signs`.
Shape::Ptr shapeOf(const BoolTree& leaves, const openvdb::math::Transform& transform) {
    auto shape = Shape::create(false);
    copyLeaves(leaves, kEverywhere, Coord(0), shape->tree());
    fillInsideTiles(shape->tree(), leaves, -1, true);
    shape->setTransform(transform.copy());
    return shape;
}

}  // namespace

namespace {

// Control points and transform of a part whose shape is there.
void putControlPoints(const std::vector<BSplineField>& from, const CoordBBox& box, const Coord& shift,
                      BSplineField& part) {
    const BSplineField& first = from.front();
    part.K = first.K;
    const auto K = static_cast<float>(part.K);
    part.controlPoints = openvdb::FloatGrid::create(K);
    for (const BSplineField& field : from)
        copyLeaves(field.controlPoints->constTree(), box, shift, part.controlPoints->tree());
    signPart(part.controlPoints->tree(), part.shape->constTree(), -1, -K);
    part.controlPoints->setName(first.controlPoints->getName());
    part.controlPoints->setTransform(first.transform().copy());
    part.shape->setTransform(first.transform().copy());
}

// Slots first: they would take the place of leaves.
openvdb::BoolTree::Ptr signsOf(const std::vector<Shape::ConstPtr>& parts, const CoordBBox& box,
                               const Coord& shift) {
    auto signs = std::make_shared<BoolTree>(false);
    for (const auto& part : parts)
        forEachInsideTile(part->constTree(), box, [&](CoordBBox inside) {
            inside.translate(shift);
            signs->sparseFill(inside, true, false);
        });
    for (const auto& part : parts) copyLeaves(part->constTree(), box, shift, *signs);
    return signs;
}

std::vector<Shape::ConstPtr> shapesOf(const std::vector<BSplineField>& parts) {
    std::vector<Shape::ConstPtr> shapes;
    for (const BSplineField& part : parts) shapes.push_back(part.shape);
    return shapes;
}

BSplineField gathered(const std::vector<BSplineField>& from, const CoordBBox& box, const Coord& shift) {
    BSplineField part;
    part.shape = Shape::create(signsOf(shapesOf(from), box, shift));
    putControlPoints(from, box, shift, part);
    return part;
}

}  // namespace

BSplineField partOf(const BSplineField& field, const LeafBox& box, const Coord& shift) {
    return gathered({field}, box, shift);
}

BSplineField joinedPart(const std::vector<BSplineField>& parts) {
    assert(!parts.empty());
    return gathered(parts, kEverywhere, Coord(0));
}

Shape::Ptr joinedShape(const std::vector<Shape::Ptr>& parts) {
    assert(!parts.empty());
    return shapeOf(*signsOf({parts.begin(), parts.end()}, kEverywhere, Coord(0)), parts.front()->transform());
}

BSplineField joinedField(const std::vector<BSplineField>& parts) {
    assert(!parts.empty());
    BSplineField field;
    field.K = parts.front().K;
    std::vector<Shape::Ptr> shapes;
    for (const BSplineField& part : parts) shapes.push_back(part.shape);
    field.shape = joinedShape(shapes);
    const auto K = static_cast<float>(field.K);
    field.controlPoints = openvdb::FloatGrid::create(K);
    for (const BSplineField& part : parts)
        copyLeaves(part.controlPoints->constTree(), kEverywhere, Coord(0), field.controlPoints->tree());
    fillInsideTiles(field.controlPoints->tree(), field.shape->constTree(), -1, -K);
    field.controlPoints->setName(parts.front().controlPoints->getName());
    field.controlPoints->setTransform(parts.front().transform().copy());
    return field;
}

openvdb::FloatGrid::Ptr joinedDetails(int parts,
                                      const std::function<openvdb::FloatGrid::Ptr(int part)>& get) {
    assert(parts > 0);
    auto joined = openvdb::FloatGrid::create(0.0f);
    for (int i = 0; i < parts; ++i) {
        const openvdb::FloatGrid::Ptr part = get(i);
        copyLeaves(part->constTree(), kEverywhere, Coord(0), joined->tree());
        if (i == 0) joined->setTransform(part->transform().copy());
    }
    return joined;
}

}  // namespace isowave
