// GLB read: glTF 2.0 as one binary file.
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/soup.h"

namespace isowave {

// The triangles (lists, strips, fans) of all nodes of the scene, or of the file where it names no scene, each moved by the
// transforms of its node and the nodes above; all in double. Back from glTF's metres with y up to mm with z up, as writeGlb
// turns them: (x, y, z) -> 1000 (x, -z, y). Morph targets have moved as far as the weights of the node, or else of the mesh, say. Positions are float32 or, as KHR_mesh_quantization has them, integers.
// Throws InputError: truncated, chunks or JSON that are none, an accessor beyond its buffer, an index beyond its points,
// nodes that hold each other, no triangles; and for what is not read: compressed (Draco, meshopt) and sparse data, buffers in
// other files.
PolygonSoup readGlb(std::string_view bytes, const std::string& name);

}  // namespace isowave
