// STL: triangles without indices, binary (little-endian float32) or text.
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/sink.h"
#include "io/mesh/soup.h"
#include "io/mesh/view.h"

namespace isowave {

// Corners with equal coordinates are one point; points stand in the order of their first appearance. Normals are passed
// over, and so are words that STL has not, as long as the file is sound.
// Throws InputError: truncated, a wrong count, a facet that is no triangle or does not end, a coordinate that is none.
PolygonSoup readStl(std::string_view bytes, const std::string& name);

// Binary, with the facets' normals. Throws OperationError where float32 is not enough: where points would become one (see
// separateFloats), and where readMesh would find fewer than kFewestSteps steps. REQUIRES: triangles.
void writeStl(Sink& sink, const MeshView& mesh, const std::string& name);

}  // namespace isowave
