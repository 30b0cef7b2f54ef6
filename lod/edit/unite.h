// Union and difference of a field with a function, in the values at lattice points.
//
//   u     s F at the lattice points, T the operand's function, both as distances in voxels, cut at w = voxelsPerK on both sides;
//         s = 1: union; s = -1: difference, for the solid less the tool is outside where what is outside or in the tool is
//   u'    min(u, T), and with a radius r, where u < r and T < r,
//
//           u' = max(r, min(u, T)) - |(r - u, r - T)|
//
//         whose zero set, where two planes meet at a right angle, is the quarter of a circle of radius r that touches both.
//   c'    quasi-interpolation of s u' K / w (volume/fit.h) at the control points from which a value that has changed is less
//         than two lattice points away on each axis; all others stay.
//
// F holds all details of the solid, T none beyond its level: where the solid's surface stays, so do the details on it, by the weight
// du'/du that the solid has in a fillet; where the operand wins, they are gone, no ghost of them being left in c'.
// Left: the same on control points of level L, with the details added afterwards. Level 0 is cut at w, 4 voxels for a distance fit, so
// that level 2 crosses from -K to K in two of its voxels: min() of such samples puts the surface wrong by tenths of them.
#pragma once

#include "lod/edit/change.h"
#include "lod/edit/tool.h"

namespace isowave::lod {

struct UniteOptions {
    bool cut = false;
    double voxelsPerK = 4;
    double radius = 0;  // voxels; 0: none
};

// How far from the operand's surface its function is needed, voxels.
double reachOf(const UniteOptions& options);

Change unite(const BSplineField& field, const Operand& operand, const UniteOptions& options,
             const Progress& progress);

}  // namespace isowave::lod
