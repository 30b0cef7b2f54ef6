// A triangle soup made a closed mesh, or refused with a line that says why.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"

namespace isowave {

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

}  // namespace isowave
