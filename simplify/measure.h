// Measuring and comparing meshes with CGAL. This header's code lives in the target isowave_measure, which
// links CGAL packages under the GPL: a program that links it is under GPL-3 as a whole.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "isowave/progress.h"
#include "isowave/mesh.h"

namespace isowave {

// Number of pairs of triangles that intersect other than in a shared vertex or edge. Exact predicates, so the
// answer does not depend on rounding, on the order of triangles or on the number of threads.
//   no shared vertex    the closed triangles have a point in common (touching counts)
//   one shared vertex   the triangles meet somewhere else too
//   one shared edge     they lie in one plane and overlap (a fold)
//   three shared        the same triangle twice
// "Shared" goes by index: merge equal points first (mergeEqualPoints), or every neighbour counts. Any index
// mesh will do, also one with holes or non-manifold edges. Triangles whose corners lie exactly on a line have
// no inside and are left out.
std::int64_t countSelfIntersections(const TriangleMesh& mesh, const Progress& progress = {});

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
};

struct MeshComparison {
    OneSidedDistance aToB, bToA;
    // Symmetric: mean and rms over both surfaces together, weighted by area; max and maxBound the larger of
    // two.
    double mean = 0, rms = 0, max = 0, maxBound = 0;
    double volumeA = 0, volumeB = 0;  // signed: positive for outward triangles of a closed mesh
    double volumeDifference = 0;      // volumeB - volumeA
};

// The point of a surface nearest to some other point, and a triangle that it lies on.
struct NearestPoint {
    Point at;
    std::uint32_t triangle;
};

// A surface made ready for many distance queries (a hierarchy of boxes). Build once, ask from many threads. Keeps the
// mesh, without normals; give it away with std::move() where memory matters.
class DistanceTarget {
  public:
    // REQUIRES: at least one triangle; finite points.
    explicit DistanceTarget(TriangleMesh mesh);
    ~DistanceTarget();
    DistanceTarget(DistanceTarget&&) noexcept;
    DistanceTarget& operator=(DistanceTarget&&) noexcept;

    // From p to the nearest point of the surface; triangles without area count as the segments that they are.
    double distance(const Point& p) const;
    NearestPoint nearest(const Point& p) const;
    // The squared distance of p where it is above `enough`, else any number that is no larger than that. Much faster than
    // distance() where the answer is mostly "near enough".
    double squaredBeyond(const Point& p, double enough) const;

    // spacing: world units (0.5 = half a millimetre for images); 0 = corners and centroids of triangles only.
    // enough: maxBound need not fall below this; to prove a limit takes fewer samples than to know the maximum to
    // 1 %, and more of them are allowed. Once a sample is farther than this, the bound is left as it is.
    // An empty `from` gives zeros. The same result, to the bit, for any number of threads.
    OneSidedDistance distanceFrom(const TriangleMesh& from, double spacing = 0, const Progress& progress = {},
                                  double enough = 0) const;
    // The same samples, without a bound (maxBound is infinite): no piece is kept, none halved once more.
    OneSidedDistance sampledDistanceFrom(const TriangleMesh& from, double spacing = 0,
                                         const Progress& progress = {}) const;

  private:
    OneSidedDistance measured(const TriangleMesh& from, double spacing, const Progress& progress,
                              std::optional<double> boundEnough) const;

    struct Tree;
    std::unique_ptr<Tree> tree_;
};

// Both sides. Throws InputError when a mesh has no triangle.
MeshComparison compareMeshes(const TriangleMesh& a, const TriangleMesh& b, double spacing = 0,
                             const Progress& progress = {}, double enough = 0);

}  // namespace isowave
