// A field -> a closed, oriented 2-manifold mesh of its zero set.
#pragma once

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave {

struct PolygonizeOptions {
    // Samples of a node along each axis: 1, 2 or 4. Memory grows with its cube.
    int refine = 1;
    // Of a sample edge: how close a vertex lies to a sign change of the spline.
    double rootTolerance = 1e-6;
    // Of a sample edge: vertices stay this far from lattice points (STL is float32).
    double rootMargin = 1e-3;
    // In units of the field, -K < iso < K: the surface is where F = iso (0.5 = outside of where F = 0, so the
    // solid is thicker). Rounded to float32.
    double iso = 0;
};

// The zero set of F - iso, F the spline itself (not a linear interpolation of samples): lattice values by
// (1,4,1)/6 on each axis, one vertex on each lattice edge whose ends differ in sign, placed on a root of the
// cubic along it. Where the signs of a cell's corners leave a choice, the sign of F in the middle of the face or the cell
// decides (polygonize/cell_table.h), and a cell that is drawn as a tunnel has vertices inside, on roots along the rays from its
// middle to corners. Value >= 0 counts as outside. The B-splines sum to 1, so F - iso is the spline with the
// control points c - iso, and everything that is said of F below holds of it. Normals are the spline's
// gradient in world coordinates; triangles are counter-clockwise seen from outside also when the transform
// mirrors. Vertices and triangles come in an order that does not depend on the number of threads.
// (1) The mesh is closed, oriented and 2-manifold for any values in the grid (polygonize/cell_table.h says
// why),
//     also for one that is no field at all: control points outside I need not even keep their sign.
// (2) Within rootTolerance of a vertex along its edge the spline changes sign, except where rootMargin moved
// it.
// (3) Every normal has length 1 to float32.
// An empty field gives an empty mesh. Throws OperationError past 2^31 - 1 vertices or triangles, InputError
// for a control point that is not finite and for a transform that is not affine or not invertible.
// REQUIRES: refine is 1, 2 or 4; 0 <= rootMargin < 0.5; rootTolerance > 0; |iso| < K.
TriangleMesh polygonize(const BSplineField& field, const PolygonizeOptions& options = {},
                        const Progress& progress = {});

}  // namespace isowave
