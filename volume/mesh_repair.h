// Meshes from files, made closed or refused with a line that says why.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "isowave/progress.h"
#include "isowave/mesh.h"

namespace isowave {

// What a mesh file says besides its polygons.
struct MeshFileInfo {
    std::string format;  // "binary STL", "ASCII STL", "OBJ", "ASCII PLY", "binary PLY", "OFF"
    std::string space;   // the word after SPACE= in a comment, as 3D Slicer writes it: LPS, RAS; or empty
    std::int64_t polygons = 0;  // as listed, before they are cut into triangles
};

// What was found in, and done to, a triangle soup.
struct MeshRepairReport {
    std::int64_t facesRead = 0;          // triangles given
    std::int64_t pointsMerged = 0;       // points that lay exactly on another one
    std::int64_t degenerateRemoved = 0;  // triangles with two equal corners
    std::int64_t duplicatesRemoved = 0;  // triangles listed more than once, either way round
    std::int64_t looseRemoved = 0;       // lone triangles that bound nothing
    std::int64_t facesFlipped = 0;       // turned round so that neighbours agree
    std::int64_t holesFilled = 0;        // boundary loops closed by a fan
    std::int64_t boundaryEdges = 0;      // edges with one triangle, before filling
    std::int64_t boundaryLoops = 0;      // simple loops that these edges form
    std::int64_t nonManifoldEdges = 0;   // edges with four, six, ... triangles: kept
    bool oriented = true;                // every edge was used equally often in both directions as read
    bool evenOdd = false;  // orientation cannot be trusted, even after turning faces: pass this on to
                           // distanceFromMesh, which then counts crossings instead of winding
    std::vector<std::string> notes;  // the same in words, one line each, for the user
};

// Steps of the coordinates' number format that a mesh must be across to be read.
inline constexpr int kFewestSteps = 1024;

// Any polygon file that CGAL reads: STL (binary, ascii), OBJ, PLY, OFF. Polygons are triangulated as fans.
// Throws InputError: missing, empty, truncated, malformed (with line or byte), no triangles, a coordinate
// that is not finite (which point), coordinates beyond 1e15 or so far from the origin that fewer than
// kFewestSteps representable steps are left across the part. No repair beyond that: points as listed (STL corners merged
// by exact position). info: optional second result.
TriangleMesh readMesh(const std::filesystem::path& path, MeshFileInfo* info = nullptr,
                      const Progress& progress = {});

struct RepairOptions {
    // The longest loop of boundary edges to close, as a fraction of the bounding box's diagonal: 0.5 closes a
    // round hole of a sixth of the diagonal across (the holes under a scanned figure), not a missing side. 0
    // refuses every hole.
    double maxHole = 0.5;
};

// Makes a closed mesh out of what was read: merges equal points, drops degenerate and duplicate triangles,
// turns faces so that neighbours agree, closes small holes. Throws InputError (object = name) where a hole is
// too large or boundaries are not loops, saying how many boundary edges there are; and where nothing is left.
// Time n log n in what was read, whatever its boundary. Throws Cancelled when progress says so.
TriangleMesh repairMesh(TriangleMesh mesh, const std::string& name, MeshRepairReport* report = nullptr,
                        const RepairOptions& options = {}, const Progress& progress = {});

// Whether a path has a mesh file's extension: .stl .obj .ply .off, in any case.
bool isMeshPath(const std::filesystem::path& path);

}  // namespace isowave
