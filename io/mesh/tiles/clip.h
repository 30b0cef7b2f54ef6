// A mesh cut along planes, so that no triangle crosses one and the pieces fit together.
//
// A triangle is cut by the planes of x, then of y, then of z, upwards. What is cut is an edge, once: both triangles at it get the same
// new vertex, which is looked up by the edge's ends and not computed again. So the pieces are the same surface, closed and 2-manifold
// where the mesh was, without T-junctions.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "io/mesh/tiles/grid.h"
#include "isowave/mesh.h"

namespace isowave {

struct ClippedMesh {
    std::vector<LatticePoint> points;           // the mesh's own, then those on planes
    std::vector<std::array<float, 3>> normals;  // one a point, or none
    std::vector<Triangle> triangles;
    // Of each triangle the number of the last plane at or below it, an axis each (TilePlanes).
    std::vector<std::array<std::int32_t, 3>> cells;
};

// An edge is cut where it meets the plane, rounded to the lattice. A triangle that lies in a plane belongs above it.
// Then points that have come to lie on one another are moved apart (keepApart()). normals: one a point, or none.
ClippedMesh clipToPlanes(std::vector<LatticePoint> points, std::vector<std::array<float, 3>> normals,
                         const std::vector<Triangle>& triangles, const TilePlanes& planes);

// Different vertices at different lattice points, so that a reader that merges by position finds the surface and no pinch: of those
// that lie on one another the first stays, each other one goes to the nearest free point that lies on the same planes and between the
// same ones. One that has no such point within 8 steps, or lies on planes of all three axes, stays.
void keepApart(std::vector<LatticePoint>& points, const TilePlanes& planes);

// The triangles of each tile, tiles in Z-order (x the lowest bit), triangles in their order.
struct TileTriangles {
    TileIndex tile{};
    std::vector<std::uint32_t> triangles;  // of the clipped mesh
    std::uint8_t octants = 0;              // with halves: bit x + 2 y + 4 z is set where there is a triangle
};
std::vector<TileTriangles> tilesOf(const ClippedMesh& mesh, const TilePlanes& planes);

// x, y and z interleaved bit by bit, x lowest; indices below 0 come first.
bool zOrderLess(const TileIndex& a, const TileIndex& b);

}  // namespace isowave
