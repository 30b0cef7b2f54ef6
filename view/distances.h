// How far the points of one surface or line are from another one: a number a vertex for the colours of a page, and what a
// histogram needs.
#pragma once

#include <memory>
#include <vector>

#include "isowave/curves.h"
#include "isowave/mesh.h"
#include "isowave/progress.h"

namespace isowave::view {

// One-sided, in world units. Meshes are sampled at the corners and the centroids of their triangles, and of a triangle of area
// A the corners weigh A/12 and the centroid 9A/12, as in isowave/measure.h without a spacing: rms and max are, but for the
// sample that is taken there, what report.json
// calls rms_to_level0 and max_to_level0. Lines are sampled at the ends (L/6) and the middle (4L/6) of segments of length L.
struct DistanceSummary {
    static constexpr int kBins = 48;

    std::vector<float> ofVertex;  // of each point, in the mesh's order; 0 where no triangle uses it
    double rms = 0, max = 0;
    std::vector<double> histogram;  // kBins of equal width from 0 to max: shares of the area or length; their sum is 1
};

class SurfaceDistance {
  public:
    // REQUIRES: at least one triangle; finite points.
    explicit SurfaceDistance(const TriangleMesh& reference);
    ~SurfaceDistance();
    // The same numbers for any number of threads.
    DistanceSummary of(const TriangleMesh& mesh, const Progress& progress = {}) const;
    // DistanceSummary::ofVertex alone, in a third of the time.
    std::vector<float> ofVertices(const TriangleMesh& mesh, const Progress& progress = {}) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

// Closed lines in the plane, the last point joined to the first.
using Rings = std::vector<std::vector<curves2d::Point>>;

class CurveDistance {
  public:
    explicit CurveDistance(const Rings& reference);
    ~CurveDistance();
    DistanceSummary of(const Rings& rings) const;

  private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

}  // namespace isowave::view
