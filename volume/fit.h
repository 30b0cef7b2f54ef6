// From signs or distances to a B-spline field whose sign agrees with the input at every lattice point near
// the surface. One function each; see docs/volume.md for the passes and what was measured.
#pragma once

#include <cstdint>
#include <functional>

#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave {

// Both fits move the lattice's origin, by a multiple of 8 on each axis, where control points would lie below
// -1, and shift the transform the other way: every field then ends at a single node. World coordinates do not
// change.

struct FitReport {
    // Lattice points whose sign was compared with the input's: I dilated by one, all those where a known
    // control point has a say.
    std::int64_t latticePoints = 0;
    // Of these, how many disagree in the end. The repair works on those of I and leaves none there unless it
    // gave up; those beside I keep their sign because nothing crosses zero so far from the surface.
    std::int64_t disagreeing = 0;
    int filterPasses = 0;  // Laplacian passes (fitBinary)
    int repairPasses = 0;  // passes that changed something
    // The repair stopped because every lattice point of I had its sign by the floor; false: at
    // kMostRepairPasses.
    bool repairAgreed = true;
    double repairFloor = 0;     // of K: what s F has to reach for that
    std::int64_t repaired = 0;  // control points changed by the repair, counted once a pass
};

// Where the repair gives up. White noise at 50 % takes 20 passes: that many times over means that it cannot
// succeed.
inline constexpr int kMostRepairPasses = 1000;

struct BinaryFitOptions {
    int passes = 3;  // Laplacian passes; 3 smooths staircases, 0 leaves the ±K weights
    double K = 1.0;
    int mostRepairPasses = kMostRepairPasses;
};

struct DistanceFitOptions {
    double halfWidth = 4.0;  // w in voxels: the distance is clamped to ±w and scaled so that ±w becomes ±K
    double band = 2.0;       // b in voxels: nodes with a corner nearer than b are kept. 0 < b <= w
    double K = 1.0;
    int mostRepairPasses = kMostRepairPasses;
    // Called before the repair, to change control points of I, and the shape's signs where they are meant to
    // follow (fitWalls() of volume/walls/wall_fit.h). Lattice point i of the distances is i + shift of the field.
    std::function<void(BSplineField& field, const openvdb::Coord& shift)> adjust = {};
};

// E§2: ±K weights on I (G dilated by {-1,0,1,2}), `passes` of the discrete Laplacian filter on I, then the
// repair. For masks and labels, whose distances would be staircases.
BSplineField fitBinary(const NodeCollection& nodes, const BinaryFitOptions& options = {},
                       FitReport* report = nullptr, const Progress& progress = {});

// Signed distance -> field by quasi-interpolation c = (8v_i - v_{i-1} - v_{i+1})/6 on each axis, then the
// repair.
// distance: signed distance in voxels (index space), negative inside, valid and active at least where
// |distance| < halfWidth; inactive voxels and tiles hold any value of the right sign with magnitude >=
// halfWidth (a level set of that half-width is exactly this). nodes of G: those with a corner where
// |distance| < band; a node whose corner signs differ is always kept.
BSplineField fitDistance(const openvdb::FloatGrid& distance, const DistanceFitOptions& options = {},
                         FitReport* report = nullptr, const Progress& progress = {});

}  // namespace isowave
