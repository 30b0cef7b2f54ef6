// Distances between meshes, sampled and bounded: what isowave/measure.h says of comparisons is done here. This folder links
// CGAL packages under the GPL: a program that links it is under GPL-3 as a whole.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "isowave/measure.h"
#include "isowave/mesh.h"
#include "isowave/progress.h"

namespace isowave {

// The point of a surface nearest to some other point, and a triangle that it lies on.
struct NearestPoint {
    Point at;
    std::uint32_t triangle;
};

// A surface with a hierarchy of boxes, for many distance queries. Build it once and ask from many threads. It
// keeps the mesh, without normals; hand the mesh over with std::move() where memory matters.
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
    // The squared distance of p where it is above `enough`, else any number that is no larger than that. Much
    // faster than distance() where most points are that near.
    double squaredBeyond(const Point& p, double enough) const;
    // The distance of the vertex or centroid farthest away, or `atLeast` where none is farther. Most cost little.
    // REQUIRES: every point is used by a triangle.
    double farthestSample(const TriangleMesh& from, double atLeast, const Progress& progress = {}) const;

    // spacing: world units (0.5 = half a millimetre for images); 0 = corners and centroids of triangles only.
    // enough: a limit that the caller wants proven; maxBound is not lowered any further once it is below.
    // Proving a limit takes fewer samples than knowing the maximum to 1 %, so more are allowed. Once a sample
    // is farther than the limit, it is disproved and maxBound is left as it is. 0: no limit.
    // An empty `from` gives zeros. The same result, to the bit, for any number of threads.
    OneSidedDistance distanceFrom(const TriangleMesh& from, double spacing = 0, const Progress& progress = {},
                                  double enough = 0) const;
    // The same samples, without a bound (maxBound is infinite): no piece is kept, none halved once more. rmsError: as for a
    // surface of which `from` is a sample.
    OneSidedDistance sampledDistanceFrom(const TriangleMesh& from, double spacing = 0,
                                         const Progress& progress = {}) const;

  private:
    OneSidedDistance measured(const TriangleMesh& from, double spacing, const Progress& progress,
                              std::optional<double> boundEnough) const;

    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace isowave
