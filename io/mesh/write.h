// Mesh files: STL (binary), PLY (binary), OBJ, OFF, GLB, with normals where the format has them.
#pragma once

#include <filesystem>
#include <string>

#include "isowave/mesh.h"

namespace isowave {

enum class MeshFormat { stl, ply, obj, off, glb };

// By extension, case-insensitive. Throws InputError naming the five formats for another one.
MeshFormat meshFormatOf(const std::filesystem::path& path);
MeshFormat meshFormatFromName(const std::string& name);
const char* extensionOf(MeshFormat format);  // with the dot: ".stl"

enum class Space {
    unspecified,  // a CAD mesh: coordinates as they are, nothing is written
    lps,          // patient coordinates as ITK and DICOM have them; SPACE=LPS in a comment
    ras           // x and y negated on writing (half a turn about z: orientation stays); SPACE=RAS
};

struct MeshWriteOptions {
    Space space = Space::unspecified;  // what to write; points of the mesh itself are LPS
    double metresPerUnit = 0.001;  // glTF is metres, Y up: points are scaled by this and turned (x, z, -y)
};

// Written under a temporary name, then renamed: a failure leaves nothing behind. Throws OperationError.
//
// Numbers. OBJ and OFF print the shortest decimals that read back exactly. PLY is float32, or float64 where
// float32 would move a point by more than 1e-4 of the mean edge or make two points one. STL and GLB have only
// float32. STL has no indices either: its readers merge corners by position, and two points that have become
// one would tear the manifold. So points stay apart:
//   points of different index are written with different coordinates (STL, GLB): of those that round to the
//   same float32 triple the first gets it, the others a free one near by, at most 2 float32 steps (at the
//   size of the mesh's largest coordinate) away on each axis. Where none is free, OperationError names the
//   format and recommends PLY. STL is also refused where the mesh is fewer than kFewestSteps (mesh_input.h)
//   float32 steps across: a part 40 mm across 1 km from the origin, which readMesh would refuse.
//
// Normals. PLY nx ny nz, OBJ vn, GLB NORMAL; STL has its facets' normals. OFF goes without: many readers
// refuse the NOFF header. The comment SPACE=LPS or SPACE=RAS stands in STL's 80-byte header, as a comment in
// PLY, OBJ and OFF, in asset.extras.SPACE of GLB. REQUIRES: normals empty or one a point; indices below
// points.size().
void writeMesh(const std::filesystem::path& path, const TriangleMesh& mesh, MeshFormat format,
               const MeshWriteOptions& options = {});

}  // namespace isowave
