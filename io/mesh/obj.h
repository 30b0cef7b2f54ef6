// OBJ: points and faces; OpenSubdiv's `t` lines as tags. Everything else is passed over.
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/sink.h"
#include "io/mesh/soup.h"
#include "io/mesh/view.h"

namespace isowave {

// Throws InputError with the line: a coordinate that is none, a face of fewer than three corners, or with a point that the
// file has not; no points, no faces.
PolygonSoup readObj(std::string_view text, const std::string& name);

void writeObj(Sink& sink, const MeshView& mesh);

}  // namespace isowave
