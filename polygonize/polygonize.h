// A field -> a closed, oriented 2-manifold mesh of its zero set.
#pragma once

#include "base/progress.h"
#include "volume/field.h"
#include "volume/triangle_mesh.h"

namespace isowave {

struct PolygonizeOptions {
    int refine = 1;              // samples of a node along each axis: 1, 2 or 4
    double rootTolerance = 1e-6; // of a sample edge: how close a vertex lies to the spline's zero along its edge
    double rootMargin = 1e-3;    // of a sample edge: vertices stay this far from lattice points (STL is float32)
};

// The zero set of the spline itself (not of a linear interpolation of samples): lattice values by (1,4,1)/6 on
// each axis, one vertex on each lattice edge whose ends differ in sign, placed on a root of the cubic along it.
// Value >= 0 counts as outside. Normals are the spline's gradient in world coordinates; triangles are
// counter-clockwise seen from outside also when the transform mirrors. Vertices and triangles come in an order
// that does not depend on the number of threads.
// An empty field gives an empty mesh. Throws OperationError past 2^32 - 2 vertices.
TriangleMesh polygonize(const BSplineField& field, const PolygonizeOptions& options = {},
                        const Progress& progress = {});

}  // namespace isowave
