// New control points in a part of a field -> a field: what is known, and the signs, follow.
//
//   c     old control points;  c': new ones on T, the points that are touched, and c elsewhere
//   F'    the values of c' at lattice points. They differ from F's on T dilated by one, S.
//   nodes of I whose corners are all outside S stay; of the others those are kept that the surface stabs, those with a corner at which
//         |F'| < b, and those that were there, unless |F'| is K at all their corners (their surface has been swallowed)
//   I'    the control points of these nodes (volume/fit/known.h), so that I' is a union of 4^3 blocks, as I was
//   sign  of F' on S, as it was elsewhere
//
// Outside S, and where I' = I, control points, what is known and signs are what they were, to the bit.
#pragma once

#include <array>
#include <vector>

#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave::lod {

struct Change {
    openvdb::FloatTree controlPoints{0.0f};  // active: touched
    std::vector<openvdb::Coord>
        filled;      // origins of leaves that all become `fill`, neighbours' changes included
    float fill = 0;  // K or -K

    bool empty() const { return controlPoints.activeVoxelCount() == 0 && filled.empty(); }
};

struct Changed {
    BSplineField field;
    std::int64_t touched = 0;  // known control points, before or after, that are other ones
    std::int64_t known = 0, forgotten = 0;
};

// nearest: b, of K: nodes with a corner where |F'| is below it are kept.
Changed apply(const BSplineField& field, const Change& change, double nearest, const Progress& progress);

// F at the 512 lattice points of a leaf, in its order.
std::array<double, 512> valuesOf(const openvdb::FloatTree& controlPoints, const openvdb::Coord& origin);

// Dilated by so many lattice points on each axis; no tiles.
openvdb::MaskTree dilated(const openvdb::MaskTree& mask, int by);

}  // namespace isowave::lod
