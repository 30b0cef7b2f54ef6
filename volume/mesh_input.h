// Meshes from files, made closed or refused with a line that says why.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "volume/triangle_mesh.h"

namespace isowave {

// What was found in, and done to, a triangle soup.
struct MeshRepairReport {
    std::int64_t facesRead = 0;          // polygons in the file
    std::int64_t pointsMerged = 0;       // points that lay exactly on another one
    std::int64_t degenerateRemoved = 0;  // triangles with two equal corners
    std::int64_t duplicatesRemoved = 0;  // triangles listed more than once
    std::int64_t facesFlipped = 0;       // turned round so that neighbours agree
    std::int64_t holesFilled = 0;        // boundary loops closed by a fan
    std::int64_t boundaryEdges = 0;      // edges with one triangle, before filling
    std::int64_t nonManifoldEdges = 0;   // edges with more than two triangles
    bool oriented = true;                // every edge was used once in each direction as read
    std::vector<std::string> notes;      // the same in words, one line each, for the user
};

// Any polygon file that CGAL reads: STL (binary, ascii), OBJ, PLY, OFF. Polygons are triangulated as fans.
// Throws InputError: missing, empty, truncated, malformed (with line or byte), no triangles, a coordinate that is
// not finite. No repair beyond that: points as listed (STL corners merged by exact position).
TriangleMesh readMesh(const std::filesystem::path& path);

// Makes a closed mesh out of what was read: merges equal points, drops degenerate and duplicate triangles, turns
// faces so that neighbours agree, closes small holes. Throws InputError (object = name) where a hole is too large
// or boundaries are not simple loops, saying how many boundary edges there are.
TriangleMesh repairMesh(TriangleMesh mesh, const std::string& name, MeshRepairReport* report = nullptr);

bool isMeshPath(const std::filesystem::path& path);

}  // namespace isowave
