// OFF in text: points and faces; tags in comments. Colours, normals and texture coordinates are passed over.
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/sink.h"
#include "io/mesh/soup.h"
#include "io/mesh/view.h"

namespace isowave {

// The first word is OFF, or with ST, C, N, 4 before it, in this order; 4OFF has homogeneous points. Comments may stand
// anywhere. First a line is taken for a point or a face, and what else stands on it for a colour. Where that does not work
// out, line breaks are taken for blanks, as the format has it. A damaged file shall not be read by accident: then nothing
// may be left over, and points and faces begin where lines do unless the file has fewer lines than them.
// Throws InputError with the line: binary OFF, truncated, a coordinate that is none, a face of fewer than three corners or
// with a point that the file has not; no points, no faces.
PolygonSoup readOff(std::string_view text, const std::string& name);

void writeOff(Sink& sink, const MeshView& mesh);

}  // namespace isowave
