// What a mesh is, and how far two meshes are apart.
//
//   MeshTopology t = topologyOf(mesh);
//   if (!t.closed() || !t.manifold()) ...
//   MeshComparison c = compareMeshes(mesh, original);   // c.max: the largest distance found, c.maxBound: none is larger
//
// countSelfIntersections() and compareMeshes() need the parts of isowave that CGAL's GPL packages are in; a library that
// was built without them (-DISOWAVE_GPL=OFF) throws OperationError that says so.
#pragma once

#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "isowave/version.h"

namespace isowave {

// Whether this build has them.
ISOWAVE_EXPORT bool canMeasureDistances();

// ---- counts

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
ISOWAVE_EXPORT MeshTopology topologyOf(const TriangleMesh& mesh);

// Number of pairs of triangles that intersect other than in a shared vertex or edge. Exact predicates, so the
// answer does not depend on rounding, on the order of triangles or on the number of threads.
//   no shared vertex    the closed triangles have a point in common (touching counts)
//   one shared vertex   the triangles meet somewhere else too
//   one shared edge     they lie in one plane and overlap (a fold)
//   three shared        the same triangle twice
// "Shared" goes by index: merge equal points first (mergeEqualPoints), or every neighbour counts. Any index
// mesh will do, also one with holes or non-manifold edges. Triangles whose corners lie exactly on a line have
// no inside and are left out.
ISOWAVE_EXPORT std::int64_t countSelfIntersections(const TriangleMesh& mesh, const Progress& progress = {});

// ---- distances

// Distances from samples of one surface to another, in world units.
//
// Samples are the corners and the centroid of every piece; a piece is a triangle, or, with a `spacing`, what
// is left of it after halving the longest edge until no point of the piece is farther than `spacing` from one
// of the piece's samples. A function v is integrated over a piece of area A as
//   A/12 (v(a) + v(b) + v(c) + 9 v(centroid)),   exact for polynomials of degree 2;
// that is exact for the square of a distance that varies linearly over the piece.
struct OneSidedDistance {
    double mean = 0, rms = 0;  // weighted by area (by number of pieces where the surface has no area)
    double max = 0;            // largest over the samples: a lower bound of the one-sided Hausdorff distance
    // An upper bound of it: no point of the surface is farther from the target. Of two bounds for a piece the
    // smaller holds: (1) a distance changes by at most the way walked from a sample; (2) the distance to one
    // triangle of the target is convex, so largest at a corner of the piece. Where the bound is more than 1 %
    // above `max`, the pieces that cause it are halved on (Tang, Lee and Kim 2009), with a limited number of
    // samples: a bound that is still far off afterwards is true, but not tight.
    double maxBound = 0;
    double area = 0;           // of the surface that the samples lie on
    std::int64_t samples = 0;  // distances that were computed
    // Where only some pieces of a surface were asked: with 95 % confidence rms is that of all of them to within this.
    double rmsError = 0;
};

struct MeshComparison {
    OneSidedDistance aToB, bToA;
    // Symmetric: mean and rms over both surfaces together, weighted by area; max and maxBound the larger of
    // two.
    double mean = 0, rms = 0, max = 0, maxBound = 0;
    double volumeA = 0, volumeB = 0;  // signed: positive for outward triangles of a closed mesh
    double volumeDifference = 0;      // volumeB - volumeA
};

// Both sides. enough: maxBound need not be proven smaller than this. Throws InputError when a mesh has no triangle.
ISOWAVE_EXPORT MeshComparison compareMeshes(const TriangleMesh& a, const TriangleMesh& b, double spacing = 0,
                                            const Progress& progress = {}, double enough = 0);

}  // namespace isowave
