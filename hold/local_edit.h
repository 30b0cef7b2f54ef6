// A change of a field near a few lattice points that makes them inside or outside and keeps the sign of all others: tried
// on a copy of the control points around, so that its effect on mesh and volume is known before the field is touched.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "volume/field.h"

namespace isowave {

struct EditPlan {
    bool fill = true;                    // the points become inside; else outside
    std::vector<openvdb::Coord> points;  // lattice points of the mesh: index space times refine
    std::vector<openvdb::Vec3d> places;  // and places between them, index space: where faces are decided
    double margin =
        0.25;  // how far |F| is beyond 0 there, in mean differences of F over crossed lattice edges
    // Lattice points this near the plan's may change with them: a plug or a cut may become thicker, which a lattice
    // finer than the control points often needs. All others keep their sign.
    int thicker = 0;
    bool whole = false;  // the points are all of a part or cavity: their control points start beyond 0
};

struct LocalEdit {
    openvdb::CoordBBox box;  // of the control points that may change, index space
    std::vector<std::pair<openvdb::Coord, float>> controlPoints;  // new values, where they differ
    double volume = 0;                                            // world units^3 that the solid gains
    int euler = 0;  // change of the Euler number of the mesh of polygonize(field, refine)
};

// The least change (volume/row_ascent.h) of the control points within reach of the plan's points. Both numbers
// are exact: the mesh of the surroundings before and after, cut out in the same way.
LocalEdit tryEdit(const BSplineField& field, int refine, const EditPlan& plan);

// Puts an edit in. Control points outside I that it moves become known, four on each axis at a time, in both
// grids; the shape takes F's sign at the lattice points within reach.
void apply(const LocalEdit& edit, BSplineField& field);

}  // namespace isowave
