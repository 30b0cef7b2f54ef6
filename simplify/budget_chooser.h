// The meshes of all steps and a budget -> the mesh that serves the budget best.
//
// A budget is a number of triangles or a distance to level 0. What is tried, and how the choice is made:
//   triangles N   Up to three steps are collapsed down to N: the finest one; the finest one of at most 4 N
//                 triangles, whose topology suits the count; and the coarsest one of at least N. Where none comes
//                 down to N, holes and parts being in the way, coarser steps follow one by one. Of those that came
//                 down the one with the smallest distance to level 0 is taken, the larger of both sides.
//   distance D    The finest step is collapsed as far as D allows, and so is each whole level that is itself within
//                 D of level 0 and has fewer parts or handles (simplify/tolerance_chain.h); the one with the fewest triangles is taken. Its distance is
//                 measured with a bound (MeshComparison::maxBound), which is at most D. A larger D never gets more
//                 triangles.
//   neither       The finest step.
// Limits on the topology choose which steps may be taken at all; a collapse changes neither genus nor
// components.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lod/simplifier.h"
#include "simplify/tolerance_chain.h"

namespace isowave {

class BudgetChooser {
  public:
    // steps: ascending, the first of them step 0, which distances are measured to. Throws InputError when the
    // limits allow none of them; `name` is what the message calls the solid. REQUIRES: steps is not empty.
    BudgetChooser(std::vector<StepMesh> steps, const TopologyLimits& limits, std::string name);

    // Throws InputError when no step comes down to the triangles, or is within the distance. What a budget
    // gets does not depend on the budgets before it.
    BudgetMesh choose(const Budget& budget, const Progress& progress = {});

  private:
    struct Trial;
    std::vector<const StepMesh*> firstTries(std::int64_t triangles) const;
    const StepMesh* coarserThan(const std::vector<const StepMesh*>& tried) const;
    BudgetMesh withTriangles(std::int64_t triangles, const Progress& progress);
    BudgetMesh withinDistance(double distance, const Progress& progress);
    Trial collapsed(const StepMesh& from, std::int64_t triangles, const Progress& progress);
    const TriangleMesh& decimated(const StepMesh& from, int times, const Progress& progress);

    std::vector<StepMesh> steps_;
    std::vector<const StepMesh*> allowed_;
    std::string name_;
    OriginalSurface original_;
    std::vector<ToleranceChain>
        chains_;  // for distances: of the finest step that is allowed, and of whole levels
    std::map<std::pair<int, int>, TriangleMesh> decimated_;  // by step and number of quarterings
};

}  // namespace isowave
