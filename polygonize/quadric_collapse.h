// A closed mesh with more triangles than its shape needs -> the same surface with fewer, by collapsing edges. Fast, and safe
// beside other sheets of the surface; the collapse that measures distances to the original is simplify/collapse.h.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"

namespace isowave {

struct CollapseOptions {
    std::int64_t triangles = 0;  // how many to leave
    double longest = 0;          // world units: no collapse makes an edge longer than this; 0: any length
    // World units: no new vertex is farther than this, root mean square, from the planes of the triangles that it stands
    // for; 0: at any distance. Planar parts collapse as far as their outline allows. It is no bound of the largest
    // distance: measure that.
    double deviation = 0;
    // By point, not 0: it stays where it is, and no edge at it is collapsed. Empty: none stays.
    std::vector<char> kept = {};
};

struct CollapseReport {
    std::int64_t collapsed = 0;  // edges; each takes two triangles along
    // Candidates that were left, most of them several times, since they would have
    std::int64_t refusedTopology = 0;   // closed a handle, joined two sheets or flattened a tetrahedron
    std::int64_t refusedShape = 0;      // turned a triangle too far, or made a needle or too long an edge
    std::int64_t refusedSheets = 0;     // made triangles that intersect, or that come too close to tell
    std::int64_t refusedDeviation = 0;  // gone farther than CollapseOptions::deviation
    int rounds = 0;
};

// Collapses edges, those of the smallest quadric error first, until at most options.triangles are left. Cubes of space are
// worked on at the same time, and each rounds its share of the collapses up, so that up to two triangles a cube may go beyond
// that (seen: 0.1 %); more stay only where no collapse is possible. The new vertex minimises the quadrics of both ends under
// the condition that the volume enclosed does not change (Garland and Heckbert 1997; Lindstrom and Turk 1998).
// (1) The mesh stays closed, oriented, 2-manifold, with its components and their genus.
// (2) No pair of intersecting triangles is made. A mesh without one has none afterwards, however thin its walls are.
// (3) The volume stays to rounding (seen: 1e-11 of a part's), unless the point that keeps it is farther from the edge than the
//     edge is long; then the edge's middle is taken.
// (4) No triangle turns by more than 75 degrees in one collapse (needles are compared with their neighbourhood), and none
//     becomes a needle (height below 0.05 of the longest side) that is thinner than the thinnest one around.
// (5) Points that are kept stay, to the bit, and so do the triangles that have kept corners only.
// Triangles that stay keep their order, and points theirs. Normals are cleared: the new vertices lie near the surface that
// the mesh was made of, not on it, and the caller knows where its normals come from.
// The same result, to the bit, for any number of threads. Memory: 240 bytes a vertex of the input.
// REQUIRES: closed, oriented, 2-manifold; finite points; fewer than 2^31 triangles; kept: empty or one a point.
void collapseByQuadrics(TriangleMesh& mesh, const CollapseOptions& options, CollapseReport* report = nullptr,
                        const Progress& progress = {});

}  // namespace isowave
