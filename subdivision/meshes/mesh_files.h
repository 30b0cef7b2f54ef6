// Polygon meshes in files: OBJ, OFF, PLY, read and written with every digit of a double (io/mesh).
//
// Creases and pinned vertices have no place of their own in these formats. In all three they can be written as
// OpenSubdiv's regression shapes do, in OBJ as a line, in OFF and PLY as a comment (`#`, `comment`) of the same text:
//     t crease 2/1/0 V1 V2 SHARPNESS        an edge, by its two vertices *counted from 0*
//     t corner 1/1/0 V SHARPNESS            a pinned vertex
// Any other `t` line of OBJ is skipped: t interpolateboundary too, since boundaries are always curves of their own
// and their corners always stay.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/mesh.h"
#include "subdivision/meshes/polygon_mesh.h"

namespace isowave::subdivision {

// By extension, in any case: obj, off or ply. Throws InputError naming the three for another one.
MeshFormat polygonFormatOf(const std::filesystem::path& path);

// Reads positions, faces and creases; texture coordinates, normals, colours, groups and materials are passed over.
// Files that gzip has compressed are inflated; their format goes by the name without .gz.
// PLY: ASCII or binary of either byte order. OBJ: negative indices count from the end. Vertices in no face are left out, and
// those behind them move up. Nothing is merged, turned or checked beyond the file itself: requireManifold() does that.
// remarks: gets a line for what is not kept: colours and the like; vertices in no face.
// Throws InputError with the line or the element and what was expected: no such file, truncated, not a number, a vertex
// that is not there. REQUIRES: format is one of the three.
PolygonMesh readPolygonMesh(const std::filesystem::path& path, std::vector<std::string>* remarks = nullptr);
PolygonMesh parsePolygonMesh(std::string_view bytes, MeshFormat format, const std::string& name,
                             std::vector<std::string>* remarks = nullptr);

// Decimals that read back to the same bits (OBJ, OFF), or float64 (PLY, binary little-endian).
std::string polygonMeshBytes(const PolygonMesh& mesh, MeshFormat format);

// Appears whole or not at all. Throws OperationError.
void writePolygonMesh(const std::filesystem::path& path, const PolygonMesh& mesh);

}  // namespace isowave::subdivision
