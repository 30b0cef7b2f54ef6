#include "lod/edit/moved.h"

#include <algorithm>
#include <cmath>

namespace isowave::lod {
namespace {

using openvdb::Coord;
using openvdb::Vec3d;
using Leaf = openvdb::FloatTree::LeafNodeType;

Vec3d indexStep(const openvdb::math::Transform& lattice, const Point& by) {
    return lattice.worldToIndex(Vec3d(by.data())) - lattice.worldToIndex(Vec3d(0));
}

// Whether no leaf holds a control point that a leaf's values at this place depend on.
bool isUniform(const openvdb::FloatTree& c, const Vec3d& low) {
    const Coord first = Coord::floor(low - Vec3d(1)) & ~7, last = Coord::floor(low + Vec3d(10));
    for (int x = first.x(); x <= last.x(); x += 8)
        for (int y = first.y(); y <= last.y(); y += 8)
            for (int z = first.z(); z <= last.z(); z += 8)
                if (c.probeConstLeaf(Coord(x, y, z))) return false;
    return true;
}

}  // namespace

MovedPart::MovedPart(const BSplineField& field, const ToolFunction& box, const Point& by, double voxelsPerK)
    : field_(field),
      box_(box),
      back_(-indexStep(field.transform(), by)),
      w_(voxelsPerK),
      scale_(field.K / voxelsPerK) {}

std::vector<Coord> MovedPart::leaves(const Progress& progress) const { return box_.leaves(progress); }

Operand::Side MovedPart::values(const Coord& origin, LeafValues& values) const {
    const Side side = box_.values(origin, values);
    if (side == Side::outside) return side;
    if (side == Side::inside) values.fill(-w_);
    const openvdb::FloatTree& c = field_.controlPoints->constTree();
    const Vec3d low = origin.asVec3d() + back_;
    if (isUniform(c, low)) {
        if (c.getValue(Coord::round(low)) > 0) return Side::outside;
        return side;
    }
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
        if (values[n] >= w_) continue;
        const Vec3d from = low + Leaf::offsetToLocalCoord(n).asVec3d();
        values[n] = std::max(values[n], std::clamp(evaluate(field_, from) / scale_, -w_, w_));
    }
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    if (*least >= w_) return Side::outside;
    return *most <= -w_ ? Side::inside : Side::mixed;
}

}  // namespace isowave::lod
