// The field: a uniform cubic tensor-product B-spline whose zero set is the surface, stored sparsely.
//
// Words (docs/design.md): lattice point, node, Node-Collection G, control point, I, known, sign, K.
#pragma once

#include <cstdint>

#include "volume/vdb.h"

namespace isowave {

// A shape says which lattice points are known and the sign of every lattice point, in the smallest form that
// OpenVDB has: active = known, value = inside (in active and inactive voxels and in tiles alike).
using Shape = openvdb::BoolGrid;

// The Node-Collection G and the sign of every lattice point. E§2.
// grid: active = voxel i is the low corner of a node that the surface stabs (its 8 corner signs differ), so
// node i spans lattice points i .. i+(1,1,1); value = lattice point i is inside.
// The transform takes lattice points to world coordinates (millimetres for images).
struct NodeCollection {
    openvdb::BoolGrid::Ptr grid;

    std::int64_t nodeCount() const { return static_cast<std::int64_t>(grid->activeVoxelCount()); }
};

// F(x) = sum_i c_i B(x - i), B the centred uniform cubic B-spline with knots at the integers on each axis.
// Negative inside, positive outside. Defined everywhere: control points outside I are worth ±K.
//
// controlPoints: active = I; inactive voxels and tiles hold -K inside and +K outside; background +K.
// shape: the same active voxels; value = the input's sign at every lattice point, true inside.
// Both grids carry one transform: lattice point (index space) -> world.
// invariant: I is a union of 4x4x4 blocks (the control points of nodes).
struct BSplineField {
    openvdb::FloatGrid::Ptr controlPoints;
    Shape::Ptr shape;
    double K = 1.0;

    // |I|
    std::int64_t controlPointCount() const {
        return static_cast<std::int64_t>(controlPoints->activeVoxelCount());
    }
    const openvdb::math::Transform& transform() const { return controlPoints->transform(); }
};

// Value of F at index-space point x, by the 64 control points around it, in double. O(64) lookups: for
// checks and single points; bulk code gathers blocks.
double evaluate(const BSplineField& field, const openvdb::Vec3d& x);

// Index-space gradient of F at x.
openvdb::Vec3d evaluateGradient(const BSplineField& field, const openvdb::Vec3d& x);

// Number of nodes that the field needs: voxels i such that the control points i-1 .. i+2 on every axis are
// all known ("defined nodes" of E-T2).
std::int64_t definedNodeCount(const BSplineField& field);
openvdb::MaskTree definedNodes(const BSplineField& field);

// Lattice points inside.
std::int64_t pointsInside(const Shape& shape);

}  // namespace isowave
