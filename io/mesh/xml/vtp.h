// VTK's XML meshes (.vtp): polygons, strips of triangles, values at points (io/vtk/data_array.h).
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/soup.h"

namespace isowave {

// Polygons and strips of all pieces; vertices and lines are passed over, and so are values. Throws InputError: no VTP, truncated,
// damaged, compressed by anything but zlib.
PolygonSoup readVtp(std::string_view bytes, const std::string& name);

}  // namespace isowave
