// Levels that hold: a local change of a coarse level's control points, after which walls and rods that are thinner than its
// voxel are whole in its mesh, at the least cost of volume. The pyramid is not touched: a correction belongs to one level that
// is written.
//
// H is the level's voxel and r the samples of it along each axis (refine); lengths are voxels of level 0, and F is scaled so
// that it is a distance beside level 0's surface. A mesh that samples F at H/r keeps a wall of thickness H/r, not more. So
// where level 0 is thinner, the wall is thickened by
//
//   e = max(0, half - t/2),  half = leastThickness H / (2 r)       t: its thickness at the nearest sample
//
// and nowhere else is the surface asked to move:
//
//   hard    F(x) <= -depth H and F(x +- half n) <= 0                 at thin samples x, n across the wall
//           F(x) <= -depth H                                         in the middle of gaps that are to close
//   soft    F(p + (e + m) N) >= 0, F(p - m N) <= 0, m = margin H      at level 0's surface p, N its normal
//           F(y) >= 0                                                 farther out, so that nothing swells between the samples
//
// The least change of the control points that meets them is found by dual coordinate ascent (volume/row_ascent.h), soft rows with
// a multiplier's weight; the hard rows alone come last. Soft rows have a dead band of m on both sides: what is thick enough
// by itself is not touched, to the bit.
#pragma once

#include <cstdint>
#include <vector>

#include "hold/thin_samples.h"
#include "volume/field.h"

namespace isowave {

struct HoldOptions {
    double leastThickness = 0.9;  // of a sample edge H/r. Below 0.75 walls tear
    double depth = 0.01;          // of H: how deep the middle of a wall lies inside
    double margin = 0.02;         // of H
    double longest = 1.5;         // of H: thicker walls keep their middle by themselves
    double rho = 0.3;             // of soft rows; the sum of a row's squared weights is 0.02 to 0.13
    double rhoHard = 0.002;       // of hard rows, as long as there are soft ones beside them
    int density = 4;              // samples per H
    double closedGaps = 0;        // of H: narrower gaps between walls are filled. 0: none
};

struct HoldReport {
    std::int64_t samples = 0;                   // thin for this level, one a cell of H/4
    std::int64_t rows = 0;                      // conditions on F
    std::int64_t unmet = 0;                     // hard ones that are not met in the end
    std::int64_t changed = 0;                   // control points
    std::int64_t insideBefore = 0, inside = 0;  // samples with F < 0, in the plain level and now
    std::int64_t thickened = 0;                 // samples where e > 0
    std::int64_t gaps = 0;                      // places of gaps that are filled, one a cell of H/4
    int rounds = 0;
    bool settled = true;
};

// What levels are held to.
class LevelHold {
  public:
    // finest: level 0's field; surface: its mesh's.
    LevelHold(FinestSurface surface, BSplineField finest, const Progress& progress = {});

    const std::vector<ThinSample>& samples() const { return samples_; }
    // The largest voxel of a level, in voxels of level 0, that keeps a wall of this thickness as it is: at refine 4.
    static double widestVoxelFor(double thickness, const HoldOptions& options = {}) {
        return 4 * thickness / options.leastThickness;
    }
    // How finely a mesh of the level should sample it: 1 where next to nothing is thin for it or below three voxels, 2, or 4 where
    // walls would have to be thickened for 2.
    int refineFor(const BSplineField& level, const HoldOptions& options = {}) const;

    // Corrects a level, a step of the same solid, for a mesh that samples it `refine` times.
    // (1) Where nothing is thin, or all conditions hold, the field keeps its bits.
    // (2) The same bits for any number of threads.
    // (3) Parts of level 0 smaller than a voxel of the level are not held: their samples would grow specks.
    // Throws Cancelled.
    HoldReport apply(BSplineField& level, int refine, const HoldOptions& options = {},
                     const Progress& progress = {}) const;

  private:
    FinestSurface surface_;
    BSplineField finest_;
    double slope_ = 0;  // of F, a voxel
    double area_ = 0;   // of the surface, voxels^2
    std::vector<ThinSample> samples_;
};

}  // namespace isowave
