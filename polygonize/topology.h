// What an index mesh is, counted: closed, manifold, oriented, components, genus, volume, area. No geometry
// library is needed for that, and a mesh that CGAL's data structures cannot hold can still be counted.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

struct ComponentTopology {
    std::int64_t vertices = 0, edges = 0, triangles = 0;
    std::int64_t euler = 0;  // V - E + F
    std::int64_t genus = 0;  // (2 - euler)/2, meaningful when the component is closed and manifold
    double volume = 0;  // world units^3, signed: positive when triangles are counter-clockwise from outside
    double area = 0;    // world units^2
};

// Degenerate triangles (two corners with one index) are counted and otherwise left out: they have no edges,
// no component and no area. Points that no triangle uses count nowhere.
struct MeshTopology {
    std::int64_t vertices = 0;             // used by a triangle
    std::int64_t triangles = 0;            // degenerate ones too
    std::int64_t boundaryEdges = 0;        // edges with one triangle
    std::int64_t nonManifoldEdges = 0;     // edges with more than two triangles
    std::int64_t misorientedEdges = 0;     // edges with two triangles that run the same way along it
    std::int64_t nonManifoldVertices = 0;  // vertices whose triangles form more than one fan
    std::int64_t degenerateTriangles = 0;  // two equal corners (same index)
    std::int64_t components = 0;           // connected by shared vertices
    std::int64_t genus = 0;                // sum over components: the solid's handles (tunnels)
    std::int64_t parts = 0;     // components that bound a part of the solid from outside: volume >= 0
    std::int64_t cavities = 0;  // components that bound a cavity from inside: volume < 0
    double volume = 0, area = 0;
    std::vector<ComponentTopology> each;  // largest |volume| first

    bool closed() const { return triangles > 0 && boundaryEdges == 0; }
    bool manifold() const {
        return nonManifoldEdges == 0 && nonManifoldVertices == 0 && degenerateTriangles == 0;
    }
    bool oriented() const { return misorientedEdges == 0; }
};

// Nearly linear in the triangles; the same numbers for any number of threads.
// REQUIRES: indices below points.size().
MeshTopology topologyOf(const TriangleMesh& mesh);

// The connected pieces of a mesh, in the order of their smallest vertices.
struct MeshComponents {
    static constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> of;     // point -> component; kNone for a point that no triangle uses
    std::vector<double> volume, area;  // of each, as ComponentTopology has them

    std::size_t count() const { return volume.size(); }
};
// What topologyOf() knows of components at a fifth of its price: no edges, so no genus.
MeshComponents componentsOf(const TriangleMesh& mesh);

// result[i]: the lowest index of a point with the coordinates of point i (-0 equals 0).
std::vector<std::uint32_t> firstEqualPoints(const std::vector<Point>& points);

// Merges points with equal coordinates, as a reader of STL must. Points come in the order of their first
// appearance, with the normal of the first; triangles keep their number and order.
TriangleMesh mergeEqualPoints(const TriangleMesh& mesh);

}  // namespace isowave
