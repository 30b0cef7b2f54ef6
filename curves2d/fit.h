// From signs or distances to a planar B-spline field whose sign agrees with the input at every lattice point
// near the curve. The 3D twin, with what was measured, is volume/fit.h.
#pragma once

#include "curves2d/row_field.h"
#include "isowave/curves.h"
#include "isowave/progress.h"

namespace isowave::curves2d {

// What a bitmap or a set of polygons comes to: the solid of the plane that is fitted.
struct Shape {
    Frame frame;                    // where lattice point (i, j) lies in the input's coordinates
    Region inside;                  // the lattice points inside
    std::vector<Segment> boundary;  // lattice coordinates, any order; only fitDistance needs it
};

// An input that was fitted: level 0, and how it was made.
struct Fitted {
    RowField<float> field;
    Fit method = Fit::distance;
    double halfWidth = 0, band = 0;  // pixels; of the distance fit
    FitReport report;
};

// Both fits shift the lattice where control points would lie below -1 on an axis, so that the first one lies at -1, and
// move the frame the other way: the pyramid of every such field ends at a single node. World coordinates stay.

struct BinaryFitOptions {
    int passes = 3;  // Laplacian passes
    double K = 1.0;
};

struct DistanceFitOptions {
    double halfWidth = 4.0;  // w in lattice steps: the distance is clamped to ±w, and ±w becomes ±K
    double band = 2.0;       // b in lattice steps: nodes with a corner nearer than b are kept; 0 < b <= w
    double K = 1.0;
};

// E section 2: ±K weights on I (stabbed nodes dilated by {-1,0,1,2}), `passes` of the discrete Laplacian
// filter on I, then the repair: while a lattice point has s F < 0.05 K, its control point changes by
// 0.1 K s - F. An empty shape gives an empty field.
template <class Real>
RowField<Real> fitBinary(const Shape& shape, const BinaryFitOptions& options = {},
                         FitReport* report = nullptr, const Progress& progress = {});

// Signed distance to shape.boundary, sign from shape.inside, then quasi-interpolation
// c = (8 v_i - v_{i-1} - v_{i+1})/6 on each axis and the repair.
template <class Real>
RowField<Real> fitDistance(const Shape& shape, const DistanceFitOptions& options = {},
                           FitReport* report = nullptr, const Progress& progress = {});

// The last pass of both fits: changes control points until the spline has the sign of `inside` at every known lattice point, by
// the margin of the method. halfWidth: of the distance fit, in pixels.
void repairSigns(RowField<float>& field, const Region& inside, Fit method, double halfWidth,
                 FitReport& report, const Progress& progress = {});

// The passes that decide which control points are known: the nodes (unit squares, by their lower corner) whose corner
// signs differ, and I around a set of nodes.
Region stabbedNodes(const Region& inside);
Region knownAround(const Region& nodes);

}  // namespace isowave::curves2d
