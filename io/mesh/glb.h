// GLB: glTF 2.0 as one binary file.
#pragma once

#include <string>

#include "io/mesh/sink.h"
#include "io/mesh/view.h"

namespace isowave {

// float32, points kept apart as separateFloats() does; `title` names node and mesh. Throws OperationError where float32 or
// 4 GiB are not enough. REQUIRES: triangles, in metres, Y up.
void writeGlb(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title);

}  // namespace isowave
