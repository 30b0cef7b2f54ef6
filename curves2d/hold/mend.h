// Parts and holes never rise from level to level: what a level has more of than the level before is joined or goes.
//
// Where curves have two parts in one part of the level before, it has torn; where they have two holes, or a hole and the
// world around, in one hole or in the world of the level before, it has closed. Of either the smaller piece is in excess.
// It is joined to the rest along lattice points where the level before has the same sign (a fill through a tear, a cut
// through a closure), or it goes as a whole (the part is dropped, the hole filled): whichever changes less area. A part
// that holds thin samples counts four times. To cut or to fill by the lesser change: Zeng, Chambers, Letscher, Ju, "To cut
// or to fill", ACM Trans. Graph. 39, 2020, there for solids and globally optimal; here one piece after the other.
//
// Joining changes control points so that the lattice points of a path get the other sign and those beside keep theirs; a
// lattice point has one sign for every choice of signs around it, so this can always be had.
#pragma once

#include <vector>

#include "curves2d/hold/thin.h"
#include "curves2d/row_field.h"

namespace isowave::curves2d {

struct Mended {
    Curves curves;
    // Parts left out because they are smaller than a pixel of the level and hold no sample.
    std::size_t islands = 0;
    std::size_t joined = 0, opened = 0;   // parts, holes
    std::size_t dropped = 0, filled = 0;  // parts and holes that went as a whole
    double area = 0;                      // that all of these changed, islands left out
};

// field: of a level of pixel H, on a lattice of `spacing` (both in pixels of level 0). before: curves of the level before,
// on a lattice of `beforeSpacing`. slope: what the field of level 0 grows by in a pixel.
struct MendTask {
    const Curves& before;
    double beforeSpacing;
    const std::vector<ThinSample>& samples;
    double H, spacing, slope;
};
Mended mend(RowField<float>& field, const MendTask& task, const Progress& progress = {});

}  // namespace isowave::curves2d
