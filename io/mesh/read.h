// Mesh files read: isowave/mesh.h declares readMesh(); here is what it and subdivision::readPolygonMesh() stand on.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/peak_memory.h"
#include "io/mesh/soup.h"
#include "isowave/mesh.h"

namespace isowave {

// What a file's bytes say. name: begins every complaint. Throws InputError (see stl.h, obj.h, off.h, ply.h, glb_reader.h, xml/vtp.h, xml/three_mf.h).
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
// Files that gzip has compressed, by their first two bytes, are inflated, to `mostBytes` at most; their format goes by the name
// without .gz.
MeshFile readMeshFile(const std::filesystem::path& path, const Progress& progress = {},
                      double mostBytes = usualMemoryLimit());

// "STL, OBJ, ...": what is read.
std::string meshInputNames();

// How to get a file of another kind in, by its extension, CAD models also by their first bytes: "part.amf" -> "is an AMF file,
// which is not read; ...". Empty for what says nothing.
std::string adviceFor(const std::filesystem::path& path);

}  // namespace isowave
