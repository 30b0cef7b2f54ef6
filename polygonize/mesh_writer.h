// Mesh files: STL (binary), PLY (binary), OBJ, OFF, GLB, with normals where the format has them.
#pragma once

#include <filesystem>
#include <string>

#include "volume/triangle_mesh.h"

namespace isowave {

enum class MeshFormat { stl, ply, obj, off, glb };

// By extension, case-insensitive. Throws InputError naming the five formats for another one.
MeshFormat meshFormatOf(const std::filesystem::path& path);
MeshFormat meshFormatFromName(const std::string& name);
const char* extensionOf(MeshFormat format);

enum class Space {
    unspecified,  // a CAD mesh: coordinates as they are, nothing is written
    lps,          // patient coordinates as ITK and DICOM have them; SPACE=LPS in a comment
    ras           // x and y negated on writing; SPACE=RAS
};

struct MeshWriteOptions {
    Space space = Space::unspecified;   // what to write; points of the mesh itself are LPS
    double metresPerUnit = 0.001;       // glTF is metres, Y up: points are scaled by this and turned (x, z, -y)
};

// Written under a temporary name, then renamed: a failure leaves nothing behind. Throws OperationError.
// STL and GLB are float32, PLY is float32 or, where float32 would move points by more than 1e-4 of the shortest
// edge's length class, float64. OBJ and OFF print the shortest decimal that reads back exactly.
void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, MeshFormat format,
               const MeshWriteOptions& options = {});

}  // namespace isowave
