// PLY: text, or binary of either byte order. The elements `vertex` (x, y, z) and `face` (the list vertex_indices or
// vertex_index) are read, and where there are no faces `tristrips`, as scanners write them: lists of triangle strips, which -1
// separates. Tags are read in comments of the header; other elements and properties are passed over.
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/sink.h"
#include "io/mesh/soup.h"
#include "io/mesh/view.h"

namespace isowave {

// In text, an element is a line, what stands on it behind its properties is passed over, and a coordinate of type float is
// rounded to float32, as it would be in binary. A corner that is no point's number comes as one beyond all points.
// Throws InputError with the line or the element: no PLY, a header that is not understood or lacks what is needed,
// truncated, a value that is no number, a coordinate of a text that is not finite.
PolygonSoup readPly(std::string_view bytes, const std::string& name);

// Binary, little-endian. float32 where that is enough (see needsFloat64), else and for polygons float64.
void writePly(Sink& sink, const MeshView& mesh);

}  // namespace isowave
