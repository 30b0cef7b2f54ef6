// What the workflow needs of simplify/, whose code links CGAL packages under the GPL. Two libraries define the functions of
// this header, and of isowave/measure.h those that measure distances; a program links one of them:
//   isowave::simplify            the real ones
//   isowave::without_simplify    nothing is there, and whoever asks for it is told so in one line
// This header is ours, and so is whatever includes it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/measure.h"
#include "isowave/mesh.h"
#include "isowave/progress.h"

namespace isowave {

// ---- meshes by budget

struct StepMesh {
    int step = 0;
    TriangleMesh mesh;  // closed, oriented, 2-manifold
    MeshTopology topology;
    double voxel = 0;  // the diagonal of one, world units
    bool isLevel = true;
};

struct TopologyLimits {
    std::optional<std::int64_t> maxGenus;  // summed over components
    std::optional<double> minComponent;    // world units^3: every component, a cavity too, has at least that
    bool allow(const MeshTopology& topology) const;
};

struct Budget {
    enum class Kind { triangles, distance, none } kind = Kind::none;
    double value = 0;  // triangles, or world units
};

struct BudgetMesh {
    TriangleMesh mesh;
    int step = 0;             // where it came from
    std::string why;          // "smallest distance to level 0 of steps 0 (1.2), 6 (0.8), 9 (2.3)"
    MeshComparison distance;  // a: this mesh, b: step 0; all zero for step 0 itself
};

}  // namespace isowave

namespace isowave::lod {

// Throws UsageError where simplify/ is not linked: "--compact needs a build with -DISOWAVE_GPL=ON ...".
void requireSimplifier(std::string_view what);

// A closed mesh down to at most `triangles`, its volume kept. No normals. REQUIRES: canMeasureDistances().
TriangleMesh collapsedByVolume(const TriangleMesh& mesh, std::int64_t triangles, const Progress& progress);

// Level 0, which coarser levels and the mesh that was read are measured against.
class ReferenceSurface {
  public:
    // From samples, without bounds; the largest distance to the reference is that of all vertices and centroids.
    struct Distances {
        OneSidedDistance toReference, fromReference;
    };
    virtual ~ReferenceSurface() = default;
    virtual Distances distances(const TriangleMesh& mesh, const Progress& progress) const = 0;
    // The first of the two; mesh: closed or not.
    virtual OneSidedDistance distanceFrom(const TriangleMesh& mesh, const Progress& progress) const = 0;
};
// REQUIRES: canMeasureDistances(); at least one triangle.
std::unique_ptr<ReferenceSurface> makeReferenceSurface(TriangleMesh mesh);

// Chooses a step for a budget and collapses it (simplify/budget.h).
class BudgetSolver {
  public:
    virtual ~BudgetSolver() = default;
    // Throws InputError when no step comes down to the triangles, or is within the distance.
    virtual BudgetMesh choose(const Budget& budget, const Progress& progress) = 0;
};
// steps: ascending, step 0 first. Throws InputError when the limits allow none of them. REQUIRES: canMeasureDistances().
std::unique_ptr<BudgetSolver> makeBudgetSolver(std::vector<StepMesh> steps, const TopologyLimits& limits,
                                               const std::string& name);

}  // namespace isowave::lod
