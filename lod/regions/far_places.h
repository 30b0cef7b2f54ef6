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

    // The samples of this surface that are farther than `limit` from the other one: all of them where that is empty. howFar:
    // without it their distances are not looked for.
    std::vector<FarPlace> farFrom(const SampledSurface& other, double limit, bool howFar,
                                  const Progress& progress) const;

    // The largest distance of a sample of this surface from the other one, or `atLeast` where that is more. What is certainly
    // nearer than the farthest sample so far is not measured: a tenth of the time of measuring all. REQUIRES: the other one
    // is not empty.
    double farthestFrom(const SampledSurface& other, double atLeast, const Progress& progress) const;

    // All of these give the same for any number of threads.

  private:
    // ask(chunk, point) for the samples begin .. end - 1, vertices before triangles, in order; chunks in parallel.
    template <class Ask>
    void forSamples(std::size_t begin, std::size_t end, const Progress& progress, const Ask& asker) const;
    std::size_t chunksOf(std::size_t begin, std::size_t end) const;
    double farthestOf(std::size_t begin, std::size_t end, const SampledSurface& other, double atLeast,
                      const Progress& progress) const;

    std::vector<Point> points_;
    std::vector<Triangle> triangles_;
    double spacing_;
    std::optional<TriangleHierarchy> hierarchy_;
};

}  // namespace isowave::lod
