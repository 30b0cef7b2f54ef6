// A triangle soup made a closed mesh, or refused with a line that says why.
#pragma once

#include <string>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/repair/report.h"

namespace isowave {

// Makes a closed mesh out of what was read: merges equal points, drops degenerate and duplicate triangles, closes cracks
// without width (repair/cracks.h), turns faces so that neighbours agree, closes small holes (repair/holes.h), turns bodies
// that are inside out (repair/bodies.h). Throws InputError (object = name) where a hole is too large, saying how wide it is
// and what helps; where many triangles hang on nothing; and where nothing is left.
// mayStayOpen: holes are left, none is refused, and bodies are not turned.
// Time n log n in what was read, whatever its boundary, but for the filling of holes. Throws Cancelled when progress says so.
TriangleMesh repairMesh(TriangleMesh mesh, const std::string& name, MeshRepairReport* report = nullptr,
                        const RepairOptions& options = {}, const Progress& progress = {});

}  // namespace isowave
