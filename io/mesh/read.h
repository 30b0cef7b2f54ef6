// Mesh files read: isowave/mesh.h declares readMesh(); here is what it and subdivision::readPolygonMesh() stand on.
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/soup.h"
#include "isowave/mesh.h"

namespace isowave {

// What a file's bytes say. name: begins every complaint. Throws InputError (see stl.h, obj.h, off.h, ply.h).
// REQUIRES: format is not glb.
PolygonSoup parseMesh(std::string_view bytes, MeshFormat format, const std::string& name);

}  // namespace isowave
