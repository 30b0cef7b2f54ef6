// Fewer parts, handles and cavities at one level by local changes of its control points, each the cheaper one of a cut
// and a fill, until limits are met.
//
// A superfluous handle is removed by filling its hole or by cutting its ring, a part by removing it or by joining it
// to another one, a cavity by filling it or by opening it: D. Zeng, E. Chambers, D. Letscher, T. Ju: "To cut or to fill: a global
// optimization approach to topological simplification", 2020. There the choice is made for all at once on a
// graph of candidate cuts and fills; here one by one, the cheapest first, which is the same wherever the
// candidates do not share places, and each choice is measured on the mesh instead of on cells.
#pragma once

#include <string>
#include <vector>

#include "hold/solid_limits.h"
#include "hold/topology_edit.h"
#include "isowave/progress.h"

namespace isowave {

struct TopologyEdits {
    std::vector<TopologyEdit> edits;  // in the order in which they were made
    SolidCounts before, after;        // of the mesh, without specks
    bool met = true;                  // after is within the limits
    std::string why;                  // where it is not: what is left over, and what was tried
};

// Changes control points of `field` so that polygonize(field, {.refine = refine}), less components smaller than
// `smallestPart` (world units^3), has no more parts, handles and cavities than the limits allow.
// (1) `after` is counted on that mesh, and so is every edit: one that does not take away exactly the one thing
//     it is for, or adds another, is undone.
// (2) What is not limited does not rise.
// (3) Signs at lattice points change in and beside plugs, cuts, removed parts and filled cavities only; F changes within 4 control
//     points of these. Within the limits nothing changes, and the price is that of counting.
// (4) The same bits for any number of threads.
// Candidates come from the persistence of F (polygonize/persistence.h): the thinnest place of each ring and wall, the
// middle of each hole and gap. Holes and rings wider than kWidestPlug lattice steps are left. Where the mesh's lattice is finer than
// the control points (refine > 1) the spline cannot bend to every plug: more places fail than at refine 1.
// The grids are copied before they are changed: others that share them see nothing.
// REQUIRES: refine is 1, 2 or 4. Throws as polygonize(), Cancelled (the field is then as it was before or
// between two edits).
TopologyEdits limitTopology(BSplineField& field, int refine, const SolidLimits& limits, double smallestPart,
                            const Progress& progress = {});
// The same for a mesh that was counted. REQUIRES: now == meshedCounts(field, refine, smallestPart).
TopologyEdits limitTopology(BSplineField& field, int refine, const SolidLimits& limits, double smallestPart,
                            const SolidCounts& now, const Progress& progress);

// Whether the lattice is small enough for limitTopology() to look at all of it as finely as the mesh does: in larger ones it finds what is
// wide, and hardly what only the mesh's finest lattice has.
bool isSearchedWhole(const BSplineField& field, int refine);

}  // namespace isowave
