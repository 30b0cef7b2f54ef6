// The algorithms on small random solids: lattice-solid, mesh-solid.
#pragma once

#include "tests/fuzz/target.h"

namespace isowave::fuzz {

// bytes -> a lattice of at most 9 points along an axis, as voxels or as signed distances; or up to six boxes and tetrahedra
// of a triangle mesh -> open() -> analyse() -> every field -> every mesh -> makeLadder(). Checked:
//   - the fit's signs are the input's unless the repair gave up (FitSummary)
//   - the pyramid restores every control point of step 0, to 1e-5 K
//   - every mesh of every step, with and without the hold, is closed, oriented and 2-manifold, by other means than polygonize's
//     own (tests/zoo/mesh_check.h)
//   - every level written as VTP, 3MF and GLB is read again as it was (written.h)
//   - from level to level no parts, handles or cavities are added, unless the report says so (limitsMissed)
std::vector<Target> shapeTargets();

}  // namespace isowave::fuzz
