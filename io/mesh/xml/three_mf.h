// 3MF, what slicers exchange: a zip archive with a model in XML (3MF Core Specification 1.3, 3mf.io).
//
// The model's unit counts: coordinates come in mm. An object holds a mesh, or components: other objects, each moved by a
// transform; what the build lists, moved by its own transforms, is what is printed, and is what is read. Items and components may
// name the part of the archive that has their object (`path`, production extension 1.1), as Bambu Studio and OrcaSlicer write it.
#pragma once

#include <string>
#include <string_view>

#include "io/mesh/soup.h"

namespace isowave {

// The triangles of all objects that the build lists, of all objects where it lists none. Colours, materials and names are not
// kept. The space is what the metadata before the objects say, as isowave writes it: SPACE=LPS. Throws InputError: no zip archive or a damaged one, no model in it, XML that is none (with line), a number that is none,
// an object that is missing or holds itself, a part that is missing.
PolygonSoup readThreeMf(std::string_view bytes, const std::string& name);

}  // namespace isowave
