// Surface inside the solid, where parts overlap or touch.
#pragma once

#include "isowave/progress.h"
#include "volume/vdb.h"

namespace isowave {

// Parts that overlap or touch leave surface inside the solid, and the distance to it says nothing about the
// solid: a dent that coarser levels may open into a void. Wherever the solid's own surface passes, there is a
// lattice edge whose signs differ: let D be an inside point's distance to the nearest such edge's middle, d
// to the solid's surface. D - d was at most 1.2 on nine real parts (and at most 0.6 for all but 1 % of their
// points), so d >= D - 1.2: a smaller distance is one to buried surface, and is raised to that. All others
// stay as they are, to the bit.
// tree: distances of a mesh, active where nearer than halfWidth; tiles by sign.
void liftFromBuried(openvdb::FloatTree& tree, double halfWidth, const Progress& progress);

}  // namespace isowave
