// A level's field, fitted again to the surface of level 0.
//
// A wavelet step keeps the coarse function that is nearest in the mean over all of space. Beside the kink
// that a distance has in the middle of a wall such a function swings: walls of half to two voxels of the
// level get thicker, thinner ones thinner, while the error in the mean stays small (docs/fidelity.md has both
// by thickness). What counts for a mesh is where the function is zero, so it is moved until it is zero on
// level 0's surface, in the mean over the support of each control point. The pyramid is not touched: this is
// for the one mesh.
#pragma once

#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave {

struct SurfaceSample {
    openvdb::Vec3d at;  // world
    double area;        // world units^2
};
// The middle of each triangle.
std::vector<SurfaceSample> surfaceSamples(const TriangleMesh& mesh);

struct RefitOptions {
    // One does most of it. With many, the function may be bent to zero off the surface too: eight gave a gear
    // wheel of 128 voxels four parts more at level 3.
    int sweeps = 1;
    // of K: where the field is farther from zero than this on the surface, the level has left that part out
    // on purpose; it is not called back.
    double reach = 0.5;
};

// With B_j(p) the B-spline of control point j at a sample p of area a, each sweep takes
//   c_j -= sum_p a B_j(p) F(p) / sum_p a B_j(p)      over the samples that c_j has a say in, for all known j at once.
// The B-splines sum to 1 everywhere, so that is the simultaneous algebraic reconstruction of F(p) = 0
// (Andersen and Kak 1984), which goes towards the least squares over the surface. Control points off the
// surface move with those on it: the slope stays. I, K and the shape are those of `level`, whose grids are
// left as they are. The same result, to the bit, for any number of threads.
BSplineField refitted(const BSplineField& level, const std::vector<SurfaceSample>& surface,
                      const RefitOptions& options = {}, const Progress& progress = {});

}  // namespace isowave
