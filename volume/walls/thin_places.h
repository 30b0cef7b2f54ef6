// Where a solid, or the space beside it, is so thin that a spline through its distances overshoots.
#pragma once

#include <vector>

#include "isowave/progress.h"
#include "volume/mesh_nearest.h"
#include "volume/vdb.h"

namespace isowave {

// A place in the middle of a wall of less than a voxel.
struct WallMiddle {
    openvdb::Vec3d at;      // index space
    openvdb::Vec3d normal;  // across, of length 1
    double thickness;       // voxels
};

struct ThinPlaces {
    // Lattice points at most two steps, along each axis, from one that has an opposite neighbour.
    openvdb::MaskTree::Ptr near;
    // Walls thinner than a voxel: one middle, the thinnest wall's, in each cell of half a voxel.
    std::vector<WallMiddle> middles;
    // Gaps thinner than a voxel, likewise.
    std::vector<WallMiddle> gaps;
    // Thicknesses of walls of at most `widest` voxels whose faces are parallel within 16 degrees (wedges have none),
    // one for each lattice point beside them, sorted.
    std::vector<float> thicknesses;
};

// Two neighbouring lattice points (26) with feet p, p' and outward normals n, n' are opposite, with a wall (< 0) or a
// gap (> 0) of thickness |a|, a = (n - n').(p' - p)/2, between their feet, if n.n' < -0.7, |p' - p| < widest, and
// |a| > 0.7 |p' - p| or |p' - p| < 1.5. (With n alone a bent wall's thickness would come out wrong by the sagitta
// between the feet, which has opposite signs for n and n'.) 0.01 < |a|: faces that touch are no gap and no wall.
// distance: signed, in voxels, of the same mesh. Only lattice points beside a kink of the distance are asked for
// their feet, those with a second difference of at least 1/2 along an axis: between faces whose normals n, n'
// have n.n' <= -0.7 the gradient turns by |n - n'| >= 1.84, so by 1.06 along some axis, and one of the two
// lattice points beside the kink sees at least half of it.
// widest: at most 4, voxels.
ThinPlaces thinPlaces(const openvdb::FloatTree& distance, const TriangleHierarchy& triangles,
                      double widest = 4, const Progress& progress = {});

// The thickness of the wall behind a foot, and where its other face is: the foot of the point `depth` behind it.
// REQUIRES: the wall ends less deep than that. thickness 0: nothing opposite there.
struct WallBehind {
    openvdb::Vec3d at, normal;
    double thickness = 0;
};
WallBehind wallBehind(const openvdb::Vec3d& foot, const openvdb::Vec3d& normal, double depth,
                      const TriangleHierarchy& triangles);

}  // namespace isowave
