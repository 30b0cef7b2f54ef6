// Where two surfaces are apart: samples of one that are farther from the other than a limit.
#pragma once

#include <optional>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"
#include "volume/mesh_nearest.h"

namespace isowave::lod {

struct FarPlace {
    Point at{};
    double distance = 0;  // HUGE_VAL where it is not known
};

// A surface to sample and to measure against. Samples are its vertices, and the middles of its triangles or, where a side is longer than
// `spacing`, of the n^2 equal parts whose sides are not.
class SampledSurface {
  public:
    // Neither is kept: points are copied. spacing: world units, above 0. May have no triangle.
    SampledSurface(const TriangleMesh& mesh, double spacing);

    bool empty() const { return !hierarchy_; }
    double spacing() const { return spacing_; }
    // Whether a point is within `limit` of the surface; world units. False where it is empty.
    bool isNear(const Point& point, double limit) const;

    // The samples of this surface that are farther than `limit` from the other one: all of them where that is empty.
    struct Far {
        std::vector<FarPlace> places;
        double largest = 0;  // distance of all samples; HUGE_VAL where the other one is empty
    };
    // howFar: without it distances are not looked for, which is faster, and `largest` is 0. The same for any number of threads.
    Far farFrom(const SampledSurface& other, double limit, bool howFar, const Progress& progress) const;

  private:
    std::vector<Point> points_;
    std::vector<Triangle> triangles_;
    double spacing_;
    std::optional<TriangleHierarchy> hierarchy_;
};

}  // namespace isowave::lod
