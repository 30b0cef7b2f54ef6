// What the repair of a triangle soup found and did, and what it may do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace isowave {

struct MeshRepairReport {
    std::int64_t facesRead = 0;          // triangles given
    std::int64_t pointsUnused = 0;       // points in no triangle, left out
    std::int64_t pointsMerged = 0;       // points that lay exactly on another one
    std::int64_t degenerateRemoved = 0;  // triangles with two equal corners
    std::int64_t duplicatesRemoved = 0;  // triangles listed more than once, either way round
    std::int64_t pointsWelded = 0;       // points on boundary edges that moved onto another such point
    double weldedFarthest = 0;           // by at most this, the mesh's units
    std::int64_t edgesSplit = 0;         // boundary edges split at points that lie on them: T-junctions
    std::int64_t looseRemoved = 0;       // lone triangles that bound nothing
    std::int64_t facesFlipped = 0;       // turned round so that neighbours agree
    std::int64_t holesFilled = 0;        // boundary loops closed by triangles
    double widestFilled = 0;             // the widest of them, the mesh's units
    std::int64_t boundaryEdges = 0;      // edges with one triangle, before filling
    std::int64_t boundaryLoops = 0;      // simple loops that these edges form
    std::int64_t nonManifoldEdges = 0;   // edges with four, six, ... triangles: kept
    std::int64_t bodiesTurned = 0;       // closed shells that were inside out
    std::int64_t nestedSolid = 0;        // closed shells inside another one that face the same way
    bool oriented = true;                // every edge was used equally often in both directions as read
    bool evenOdd = false;  // orientation cannot be trusted, even after turning faces: pass this on to
                           // distanceFromMesh, which then counts crossings instead of winding
    std::vector<std::string> notes;  // the same in words, one line each, for the user
};

struct RepairOptions {
    // The widest hole to close, as a fraction of the bounding box's diagonal; squared and times pi/4, the largest area; and
    // times 1.5, the largest area as a share of the mesh's. 1/6 closes the holes under a scanned figure and a crack of any
    // length, not a missing side. 0 refuses every hole.
    double maxHole = 1.0 / 6;
    // Instead: the widest hole to close, in the mesh's units, whatever its area.
    std::optional<double> closeHoles = {};
    // Distance between neighbouring coordinates that the mesh's file can tell apart, in the mesh's units. Not given: that of
    // float32 at the largest coordinate where float32 holds all coordinates, of float64 otherwise.
    std::optional<double> step = {};
    // Leave open what is open.
    bool mayStayOpen = false;
};

}  // namespace isowave
