// VTK's XML meshes written: .vtp, PolyData (https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html).
#pragma once

#include "io/mesh/sink.h"
#include "io/mesh/view.h"

namespace isowave {

// Polygons, and at the points their normals and distances, which are the active ones. Numbers are appended as they are, little-endian;
// coordinates are float32 where that is enough (needsFloat64), indices 32 bits where they fit.
void writeVtp(Sink& sink, const MeshView& mesh);

}  // namespace isowave
