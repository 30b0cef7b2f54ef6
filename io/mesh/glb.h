// GLB: glTF 2.0 as one binary file.
#pragma once

#include <string>

#include "io/mesh/sink.h"
#include "io/mesh/view.h"

namespace isowave {

// float32, points kept apart as separateFloats() does. Where the mesh is farther from the origin than twice its extent, points
// are relative to the middle of its box, and the node's translation, in double, puts them back; `title` names node and mesh. Throws OperationError where float32 or
// 4 GiB are not enough. REQUIRES: triangles, in metres, Y up.
void writeGlb(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title);

// Points that are relative to `origin` already: it is the node's translation, and points that float32 holds are stored as they are.
void writeGlbAround(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title,
                    const Point& origin);

}  // namespace isowave
