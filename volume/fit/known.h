// Where a field's control points are known, and what they are before anything is fitted: the first passes of every fit.
//
//   known   kept nodes -> their corners -> dilated by one: G + {-1,0,1,2} on each axis
//   origin  the lattice's origin moved so that no control point lies below -1
//   shape   the input's sign at every lattice point, in leaves and tiles
//   field   control points of ±K by sign, active on I
#pragma once

#include <openvdb/tree/LeafManager.h>

#include <memory>
#include <vector>

#include "volume/distance/leaves.h"
#include "volume/field.h"
#include "volume/leaf_words.h"
#include "volume/tiles.h"

namespace isowave::fitting {

// I = G dilated by {-1,0,1,2} on each axis = corners of G dilated by {-1,0,1}.
openvdb::MaskTree knownAround(const openvdb::MaskTree& nodes);

// Halving a domain that lies at -1 and above ends at one node, control points -1 .. 2. One that straddles the
// origin ends at -2 .. 2, two nodes, for ever. So the lattice is shifted, by whole leaves, until nothing lies
// below -1. Returns the shift: lattice point i of the source is lattice point i + shift of the field.
openvdb::Coord moveOrigin(openvdb::MaskTree& known);
// By how much, for what is known in this box.
openvdb::Coord shiftOf(const openvdb::CoordBBox& known);
openvdb::math::Transform::Ptr shiftedTransform(const openvdb::math::Transform& transform,
                                               const openvdb::Coord& shift);

// Signs of distances, and of a grid that holds signs.
inline bool isInside(float distance) { return distance < 0; }
inline bool isInside(bool inside) { return inside; }
inline LeafWords signsOf(const openvdb::FloatTree::LeafNodeType& leaf) {
    return negativeWordsOf(leaf.buffer().data());
}
inline LeafWords signsOf(const openvdb::BoolTree::LeafNodeType& leaf) { return insideWordsOf(leaf); }

// The signs of a source, a tree in its own coordinates (lattice point i of the source is i + shift of the
// field; shift is whole leaves), for one thread: of one lattice point of the field, and of a leaf.
template <class Tree>
class Signs {
  public:
    Signs(const Tree& source, const openvdb::Coord& shift) : accessor_(source), shift_(shift) {}
    bool operator()(const openvdb::Coord& c) const { return isInside(accessor_.getValue(c - shift_)); }
    LeafWords leaf(const openvdb::Coord& origin) const {
        if (const auto* there = accessor_.probeConstLeaf(origin - shift_)) return signsOf(*there);
        LeafWords words;
        words.fill((*this)(origin) ? ~std::uint64_t{0} : 0);
        return words;
    }

  private:
    openvdb::tree::ValueAccessor<const Tree> accessor_;
    openvdb::Coord shift_;
};

// makeInside() returns the signs of the source for one thread; source: a tree, in its own coordinates, whose
// root regions cover every inside region.
template <class Source, class MakeInside>
Shape::Ptr makeShape(const openvdb::MaskTree& known, const Source& source, const openvdb::Coord& shift,
                     const MakeInside& makeInside) {
    auto shape = Shape::create(false);
    shape->setTree(std::make_shared<openvdb::BoolTree>(known, false, false, openvdb::TopologyCopy()));
    openvdb::tree::LeafManager<openvdb::BoolTree> leaves(shape->tree());
    leaves.foreach ([&makeInside](openvdb::BoolTree::LeafNodeType& leaf, std::size_t) {
        setInside(leaf, makeInside().leaf(leaf.origin()));
    });
    fillTiles(shape->tree(), makeInside);
    fillRootTiles(
        shape->tree(), source, [&shift](const openvdb::Coord& c) { return c + shift; }, makeInside);
    return shape;
}

// Control points of +-K by sign everywhere, active on I.
BSplineField makeField(Shape::Ptr shape, double K, const openvdb::math::Transform& transform);
// The same field of leaves that were made by themselves: makeLeaf(), then what their known control points are.
BSplineField fieldOfLeaves(Shape::Ptr shape, double K, const openvdb::math::Transform& transform,
                           std::vector<FloatLeafPtr> leaves);
FloatLeafPtr makeLeaf(const openvdb::BoolTree::LeafNodeType& shape, double K);

}  // namespace isowave::fitting
