// Measuring and comparing meshes with CGAL. This header's code lives in the target isowave_measure, which
// links CGAL packages under the GPL: a program that links it is under GPL-3 as a whole.
#pragma once

#include <cstdint>
#include <memory>

#include "base/progress.h"
#include "volume/triangle_mesh.h"

namespace isowave {

// Number of pairs of triangles that intersect other than in a shared vertex or edge. Exact predicates.
std::int64_t countSelfIntersections(const TriangleMesh& mesh, const Progress& progress = {});

// Distances from samples of one surface to another, in world units.
struct OneSidedDistance {
    double mean = 0, rms = 0;   // weighted by area
    double max = 0;             // largest over the samples: a lower bound of the Hausdorff distance
    double maxBound = 0;        // max + the largest distance of any point of the surface to a sample: an upper bound
    std::int64_t samples = 0;
};

struct MeshComparison {
    OneSidedDistance aToB, bToA;
    double mean = 0, rms = 0, max = 0, maxBound = 0;  // symmetric: mean and rms over both, max of the two
    double volumeA = 0, volumeB = 0;
    double volumeDifference = 0;                      // volumeB - volumeA
};

// A surface made ready for many distance queries (an AABB tree). Build once, ask from many threads.
class DistanceTarget {
  public:
    // REQUIRES: at least one triangle.
    explicit DistanceTarget(const TriangleMesh& mesh);
    ~DistanceTarget();
    DistanceTarget(DistanceTarget&&) noexcept;
    DistanceTarget& operator=(DistanceTarget&&) noexcept;

    double distance(const Point& p) const;

    // Samples of `from`: vertices and centroids of its triangles, subdivided until no point of the surface is
    // farther than `spacing` (world units) from a sample; 0 = vertices and centroids only.
    OneSidedDistance distanceFrom(const TriangleMesh& from, double spacing = 0, const Progress& progress = {}) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

// Both sides. Throws InputError when a mesh has no triangle.
MeshComparison compareMeshes(const TriangleMesh& a, const TriangleMesh& b, double spacing = 0,
                             const Progress& progress = {});

}  // namespace isowave
