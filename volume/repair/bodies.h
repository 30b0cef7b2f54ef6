// Closed shells turned so that each body's outside is outside, before winding numbers add them up.
#pragma once

#include <cstdint>

#include "volume/repair/edges.h"

namespace isowave::repair {

struct Bodies {
    std::int64_t turned = 0;  // shells
    std::int64_t nested = 0;  // shells wholly inside another one that face the way it does: solid in solid
};

// A shell is what hangs together across edges; across an edge of four and more triangles only where parts would not be closed
// without each other. It is inside out where its volume is negative.
//
//   not inside another shell, inside out    a mirrored body: it is turned, and with it all that lies in it
//   inside another shell, inside out        a cavity: it stays, and so does one inside several shells that overlap
//   inside another shell, not inside out    stays: solid by its winding number, and counted in `nested`
//
// So a body that overlaps another one, and is inside out, adds to it and takes nothing away; and a hollow body whose two
// shells were both mirrored stays hollow. Inside is where all corners and all centres of triangles have a winding number
// that is not 0; places on the other shell itself do not count. n log n in the triangles.
// REQUIRES: isBalanced(edgeUses(mesh.triangles)), no edge of odd use.
Bodies orientBodies(TriangleMesh& mesh, const std::vector<EdgeUse>& uses, const Progress& progress);

}  // namespace isowave::repair
