// A field as the coders take it: the known points of a box, with a value and a sign each, and the way back to grids.
//
// What is not stored follows: an unknown point between two known ones of its row has the sign of the one before it, because an edge
// whose ends have two signs belongs to a node, whose control points are all known; before the first and after the last known
// point of a row all is outside, because solids are finite. fieldPointsOf() checks that this holds for the field at hand.
#pragma once

#include <vector>

#include "compress/coder/lattice.h"
#include "compress/coder/lattice_values.h"
#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave::compress {

struct FieldPoints {
    openvdb::Coord origin;  // lattice point of the box's low corner
    BitBox nodes{{1, 1, 1}};
    Lattice lattice;
    std::vector<float> c;  // of the known points, raster order
    Flags inside;          // of the known points
    double K = 1;
    openvdb::math::Transform::Ptr transform;
};

// Points of the box, known or not; beyond that a bit for each would take more than a gigabyte.
inline constexpr double kMostBoxPoints = 8589934592.0;  // 2^33: 2048 along each axis

// name: of the field in messages. Throws InputError: no known points, a box beyond kMostBoxPoints, control points that are no
// union of nodes, signs of unknown points that do not follow from the known ones, Cancelled by the progress.
FieldPoints fieldPointsOf(const BSplineField& field, const std::string& name, const Progress& progress);

BSplineField fieldOf(const FieldPoints& points);

}  // namespace isowave::compress
