// 3MF written: a zip archive with a model in XML (3MF Core Specification 1.3, 3mf.io).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/mesh/sink.h"
#include "io/mesh/view.h"

namespace isowave {

// One object for each part (solid_parts.h), each an item of the build: `title` where there is one, else "title 1", "title 2" and so
// on; each has a colour, a base material, of eight that come round. The model's unit is mesh.metresPerUnit: micron, millimeter,
// centimeter, meter, inch or foot, else points are scaled to millimeters. Numbers are float32 where that is enough (needsFloat64).
// Deflated, with fixed times: equal meshes give equal files. name: begins complaints. Throws OperationError where the archive
// cannot be made. REQUIRES: triangles.
void writeThreeMf(Sink& sink, const MeshView& mesh, const std::string& name, const std::string& title);

// Red, green and blue, 0 to 255, sRGB.
using ModelColour = std::array<std::uint8_t, 3>;
// The eight, by turns.
ModelColour modelColour(std::size_t i);
// "#E69F00"
std::string textOf(const ModelColour& colour);

// Meshes that are an object each, whatever shells they have.
struct ModelObject {
    std::string name;
    ModelColour colour{};
    TriangleMesh mesh;
};
// A file of these objects, in their order, placed and in the unit as writeMesh() does it; appears whole or not at all. Throws
// OperationError. REQUIRES: an object, and a triangle in each.
void writeThreeMfObjects(const std::filesystem::path& path, const std::vector<ModelObject>& objects,
                         const MeshWriteOptions& options);

}  // namespace isowave
