// From the meshes of all steps and a budget -> the mesh that spends it best. In the target isowave_measure (GPL-3
// when linked), as collapse.h is.
//
// A budget is a number of triangles or a distance to level 0. What is tried, and how the choice is made:
//   triangles N   Up to three steps are collapsed down to N: the finest one; the finest one of at most 4 N
//                 triangles, whose topology suits the count; and the coarsest one of at least N. Where none comes
//                 down to N, holes and parts being in the way, coarser steps follow one by one. Of those that came
//                 down the one with the smallest distance to level 0 is taken, the larger of both sides.
//   distance D    The finest step is collapsed as far as D allows, and so is the coarsest step that is itself
//                 within D of level 0; the one with fewer triangles is taken. Its distance is measured with a
//                 bound (MeshComparison::maxBound), which is at most D.
//   neither       The finest step.
// Limits on the topology choose which steps may be taken at all; a collapse changes neither genus nor components.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simplify/collapse.h"
#include "polygonize/topology.h"

namespace isowave {

struct StepMesh {
    int step = 0;
    TriangleMesh mesh;  // closed, oriented, 2-manifold
    MeshTopology topology;
    double voxel = 0;  // the diagonal of one, world units
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

class BudgetChooser {
  public:
    // steps: ascending, the first of them step 0, which distances are measured to. Throws InputError when the
    // limits allow none of them; `name` is what the message calls the solid. REQUIRES: steps is not empty.
    BudgetChooser(std::vector<StepMesh> steps, const TopologyLimits& limits, std::string name);

    // Throws InputError when no step comes down to the triangles, or is within the distance. What a budget gets does
    // not depend on the budgets before it.
    BudgetMesh choose(const Budget& budget, const Progress& progress = {});

  private:
    struct Trial;
    BudgetMesh withTriangles(std::int64_t triangles, const Progress& progress);
    BudgetMesh withinDistance(double distance, const Progress& progress);
    Trial collapsed(const StepMesh& from, std::int64_t triangles, const Progress& progress);
    std::optional<TriangleMesh> collapsedWithin(const StepMesh& from, double distance,
                                                const Progress& progress);
    const TriangleMesh& thinned(const StepMesh& from, int times, const Progress& progress);
    MeshComparison measured(const TriangleMesh& mesh, double enough, const Progress& progress) const;
    double roughDistance(const TriangleMesh& mesh, const Progress& progress) const;

    std::vector<StepMesh> steps_;
    std::vector<const StepMesh*> allowed_;
    std::string name_;
    DistanceTarget original_;
    TriangleMesh sample_;  // some of level 0's triangles, for distances that only rank
    std::map<std::pair<int, int>, TriangleMesh> thinned_;  // by step and number of quarterings
};

}  // namespace isowave
