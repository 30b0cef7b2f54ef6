// Solids written as functions, for tables: negative inside, in voxels. None changes faster than its `slope` voxels a
// voxel, so that a block that is farther from the surface than that need not be sampled.
#pragma once

#include <functional>

#include "volume/vdb.h"

namespace isowave::bench {

struct AnalyticSolid {
    std::function<double(const openvdb::Vec3d&)> value;
    double slope;   // Lipschitz constant of value
    double extent;  // every point inside has coordinates of at most this magnitude
};

// A plate 12.4 voxels thick with n x n through-holes of radius 1.2 to 8 voxels, 32 apart; on it a wall 2 voxels thick and
// 40 high; above it 2n balls of radius 1 to 4. Genus n^2, 2n + 1 parts. n = 6 is the plate of 256 voxels.
AnalyticSolid plateSolid(int n);
double plate(const openvdb::Vec3d& p, int n);  // the same, about the origin

// A box of half-size `half`, of which one of the two labyrinths of a gyroid is left.
AnalyticSolid gyroidBlock(double period, double half);

// A ball of trabecula-like struts and plates: where a sum of random waves, all of length `wave` but for a tenth, is above a
// limit (Gaussian random fields cut at a level look like cancellous bone). The same one every time.
AnalyticSolid trabecularBall(double wave, double radius);

// The solid turned by 0.7 radians about (1, 2, 3), so that nothing lies along the lattice.
AnalyticSolid turned(const AnalyticSolid& solid);

}  // namespace isowave::bench
