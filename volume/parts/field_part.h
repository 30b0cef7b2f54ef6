// Parts of a field: boxes of whole leaves that are cut out, worked on by themselves, and joined again to the very field that
// would have come out of the whole.
//
// A part's grids know the control points and the signs of its box; beyond it everything is outside and nothing known. So a slot of
// a part's tree, a region without leaves, may lie inside only as far as the box reaches: such a slot is split until each of its own
// lies in the box or beyond it. A field that is joined has no such slots any more: its tree follows from its leaves and signs, to
// the byte of its file.
#pragma once

#include <functional>
#include <vector>

#include "volume/field.h"

namespace isowave {

// Whole leaves: both corners' coordinates are multiples of 8, the upper one less 1.
using LeafBox = openvdb::CoordBBox;

// The part of `field` in a box, moved by whole leaves: lattice point i of the field is i + shift of the part, whose transform is
// the field's all the same. Copies leaves.
BSplineField partOf(const BSplineField& field, const LeafBox& box,
                    const openvdb::Coord& shift = openvdb::Coord(0));

// The part that these make together: as joinedField(), but of a part.
BSplineField joinedPart(const std::vector<BSplineField>& parts);

// The field of which these are parts: no two of them have a leaf in common, all have one K and one transform.
// REQUIRES: at least one; the signs of all together are those of a field. Copies leaves.
BSplineField joinedField(const std::vector<BSplineField>& parts);

// The same for grids that have a background of 0 and no signs. Each of them is asked for when its turn comes, and let go.
openvdb::FloatGrid::Ptr joinedDetails(int parts, const std::function<openvdb::FloatGrid::Ptr(int part)>& get);

// The same for shapes.
Shape::Ptr joinedShape(const std::vector<Shape::Ptr>& parts);

// Nodes of `tree`, beside those of a part's shape whose coordinate along `halved` is twice as large (-1: none), made where a slot of
// the tree may be no region of one sign; then all slots set by the signs of the shape: `inside` or the background.
template <class Tree>
void signPart(Tree& tree, const openvdb::BoolTree& shape, int halved, typename Tree::ValueType inside);

}  // namespace isowave

#include "volume/parts/sign_part.h"
