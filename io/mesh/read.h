// Mesh files read: isowave/mesh.h declares readMesh(); here is what it and subdivision::readPolygonMesh() stand on.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "io/mesh/soup.h"
#include "isowave/mesh.h"

namespace isowave {

// What a file's bytes say. name: begins every complaint. Throws InputError (see stl.h, obj.h, off.h, ply.h, glb_reader.h).
PolygonSoup parseMesh(std::string_view bytes, MeshFormat format, const std::string& name);

// What readMesh() reads, and what only a repair and a report ask for.
struct MeshFile {
    TriangleMesh mesh;
    MeshFileInfo info;
    // Between neighbouring coordinates that the file can tell apart, at its largest one: of float32 or float64, or a unit of
    // the last digit of a text, whichever is more.
    double step = 0;
    std::string droppedNote;  // "colours and materials are not kept"; empty where all is
};
MeshFile readMeshFile(const std::filesystem::path& path, const Progress& progress = {});

// How to get a file of another kind in, by its extension in lower case: ".step" -> "is a CAD model in STEP; ...". Empty for an
// extension that says nothing.
std::string adviceFor(std::string_view extension);

}  // namespace isowave
