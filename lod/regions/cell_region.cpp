#include "lod/regions/cell_region.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace isowave::lod {
namespace {

using openvdb::Coord;
using openvdb::CoordBBox;

// i 2^halvings; lattices of solids stay far from where an int ends.
Coord scaled(const Coord& c, const std::array<int, 3>& halvings) {
    return {c.x() << halvings[0], c.y() << halvings[1], c.z() << halvings[2]};
}

// Runs of cells along z, as the control points on the finer lattice that F in them depends on.
std::vector<CoordBBox> runsOf(const Cells& cells, const std::array<int, 3>& halvings) {
    std::vector<CoordBBox> runs;
    Coord last;
    for (auto it = cells.cbeginValueOn(); it; ++it) {
        const Coord cell = it.getCoord();
        const Coord high = scaled(cell.offsetBy(1), halvings).offsetBy(1);
        if (!runs.empty() && cell == last.offsetBy(0, 0, 1))
            runs.back().max() = high;
        else
            runs.emplace_back(scaled(cell, halvings).offsetBy(-1), high);
        last = cell;
    }
    return runs;
}

}  // namespace

Coord cellAt(const openvdb::math::Transform& lattice, const Point& world) {
    return Coord::floor(lattice.worldToIndex(openvdb::Vec3d(world[0], world[1], world[2])));
}

Cells parentsOf(const Cells& cells, const std::array<int, 3>& halvings) {
    Cells parents;
    openvdb::tree::ValueAccessor<Cells> put(parents);
    for (auto it = cells.cbeginValueOn(); it; ++it) {
        const Coord c = it.getCoord();
        put.setValueOn({c.x() >> halvings[0], c.y() >> halvings[1], c.z() >> halvings[2]});
    }
    return parents;
}

CellDistance::CellDistance(const Cells& cells, const std::array<int, 3>& halvings,
                           const openvdb::math::Transform& lattice)
    : cells_(runsOf(cells, halvings)),
      step_(lattice.voxelSize()),
      tree_(std::max<std::size_t>(1, cells_.size()), kInLeaf) {
    assert(!cells_.empty());
    boxes_.resize(tree_.boxCount());
    tree_.build(
        tree_.root(), [this](const Range& range) { divide(range); },
        [this](const Range& range) { bound(range); });
}

void CellDistance::divide(const Range& range) {
    CoordBBox all;
    for (std::size_t i = range.begin; i < range.end; ++i) all.expand(cells_[i]);
    const auto axis = static_cast<int>(all.maxExtent());
    const auto first = cells_.begin();
    std::nth_element(first + std::ptrdiff_t(range.begin), first + std::ptrdiff_t(range.middle()),
                     first + std::ptrdiff_t(range.end), [axis](const CoordBBox& a, const CoordBBox& b) {
                         return a.min()[axis] + a.max()[axis] < b.min()[axis] + b.max()[axis];
                     });
}

void CellDistance::bound(const Range& range) {
    CoordBBox& box = boxes_[range.box];
    if (!tree_.isLeaf(range)) {
        box = boxes_[range.left().box];
        box.expand(boxes_[range.right().box]);
        return;
    }
    for (std::size_t i = range.begin; i < range.end; ++i) box.expand(cells_[i]);
}

// HUGE_VAL: the box of a leaf that holds nothing.
double CellDistance::squaredTo(const CoordBBox& box, const Coord& point) const {
    if (box.empty()) return HUGE_VAL;
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int beyond = std::max({box.min()[axis] - point[axis], point[axis] - box.max()[axis], 0});
        const double length = beyond * step_[axis];
        sum += length * length;
    }
    return sum;
}

double CellDistance::at(const Coord& point, double most) const {
    double least = most * most * 1.0001;  // what is not nearer comes back as it is, beyond `most`
    tree_.nearestFirst(
        least, [&](std::size_t box) { return squaredTo(boxes_[box], point); },
        [&](const Range& leaf) {
            for (std::size_t i = leaf.begin; i < leaf.end; ++i)
                least = std::min(least, squaredTo(cells_[i], point));
        });
    return std::sqrt(least);
}

CoordBBox CellDistance::boxWithin(double distance) const {
    CoordBBox box = boxes_.front();
    for (int axis = 0; axis < 3; ++axis) {
        const int reach = static_cast<int>(std::ceil(distance / step_[axis]));
        box.min()[axis] -= reach;
        box.max()[axis] += reach;
    }
    return box;
}

}  // namespace isowave::lod
