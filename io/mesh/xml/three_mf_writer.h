// 3MF written: a zip archive with a model in XML (3MF Core Specification 1.3, 3mf.io).
#pragma once

#include <string>

#include "io/mesh/sink.h"
#include "io/mesh/view.h"

namespace isowave {

// One object for each part (solid_parts.h), each an item of the build: `title` where there is one, else "title 1", "title 2" and so
// on; each has a colour, a base material, of eight that come round. The model's unit is mesh.metresPerUnit: micron, millimeter,
// centimeter, meter, inch or foot, else points are scaled to millimeters. Numbers are float32 where that is enough (needsFloat64).
// Deflated, with fixed times: equal meshes give equal files. name: begins complaints. Throws OperationError where the archive
// cannot be made. REQUIRES: triangles.
void writeThreeMf(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title);

}  // namespace isowave
