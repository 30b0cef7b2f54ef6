// Mesh files written: isowave/mesh.h declares writeMesh(); here is what it and subdivision::writePolygonMesh() stand on.
#pragma once

#include <filesystem>
#include <span>

#include "io/mesh/sink.h"
#include "io/mesh/view.h"
#include "isowave/mesh.h"

namespace isowave {

// The formats that are written, each with its extension, which is its name behind a dot.
struct MeshFormatName {
    MeshFormat format;
    const char* extension;
};
std::span<const MeshFormatName> meshFormatNames();

// The points as they are: for GLB they must already be what glTF asks for. path: for complaints, and GLB's name of the mesh.
// REQUIRES: triangles, for STL, GLB and 3MF.
void printMesh(Sink& sink, const MeshView& mesh, MeshFormat format, const std::filesystem::path& path);

}  // namespace isowave
