// Cracks without width: points that should be one and differ in their last digits, and T-junctions, where a long edge runs
// along several short ones.
#pragma once

#include <cstdint>

#include "volume/repair/edges.h"

namespace isowave::repair {

struct Cracks {
    std::int64_t welded = 0;  // points that became another one
    double farthest = 0;      // apart, of these
    std::int64_t split = 0;   // edges at points that lie on them
};

// Points on boundary edges (of an odd number of triangles) that lie within a tolerance of each other become the least of
// them, by x, y, z; then boundary edges are split at the boundary points that lie within the tolerance of their inside. What
// is no boundary is not touched, so a closed part stays as it is however fine it is.
//
// The tolerance is the least of 4 step, and of 1e-8, 1e-7, 1e-6, 1e-5 of the diagonal where that is more, that leaves no
// boundary, or the fewest boundary edges; never more than a quarter of the median boundary edge. Points are found by a grid of that size: the outcome does not depend on their
// order. A chain of points that is longer than twice the tolerance is left alone; a tolerance at which more than 64 points lie
// in one cell of the grid is too coarse for the mesh, and is not tried.
//
// step: what the file's coordinates can tell apart. Points keep their places in mesh.points, some unused.
Cracks closeCracks(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, double step,
                   const Progress& progress);

}  // namespace isowave::repair
