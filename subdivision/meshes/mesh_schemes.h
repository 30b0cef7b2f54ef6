// The table of subdivisions of meshes. It stands above the schemes: they know mesh_scheme.h only.
#pragma once

#include <span>
#include <string_view>

#include "subdivision/meshes/mesh_scheme.h"

namespace isowave::subdivision {

std::span<const MeshScheme> meshSchemes();
// Throws InputError that lists the names.
const MeshScheme& meshScheme(std::string_view name);

}  // namespace isowave::subdivision
