// Collects the meshes of all steps, then makes one mesh a budget.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/stage_clock.h"
#include "isowave/ladder.h"
#include "lod/simplifier.h"
#include "volume/field.h"

namespace isowave::lod {

// Throws UsageError where a budget is asked for that this build, or this solid, cannot have.
void checkBudgets(const BudgetOptions& options, bool openBorder);
// Throws UsageError where both budgets and regions are asked for.
void requireNoRegions(const BudgetOptions& options, const LevelOptions& levels);

class Budgets {
  public:
    // inputTriangles: what a ratio is a share of; nothing: the triangles of level 0. input: what a tolerance refers to; null:
    // level 0.
    Budgets(const BudgetOptions& options, std::optional<std::int64_t> inputTriangles,
            std::shared_ptr<const TriangleMesh> input, StepOrder order);

    bool wanted() const { return !asked_.empty(); }
    // REQUIRES: steps in ascending order, step 0 first; the mesh is not empty.
    void add(int step, const BSplineField& field, const TriangleMesh& mesh, const MeshTopology& topology);
    // name: what messages call the solid. Call it once: the meshes of the steps are given away.
    std::vector<BudgetLevel> make(const std::string& name, const LadderVisitor& visitor,
                                  const Progress& progress, StageClock& clock);

  private:
    struct Asked {
        Budget budget;
        double ratio = 0;  // of the triangles that ratios are shares of, where not 0
    };
    void measureInput(const std::string& name, const Progress& progress);
    BudgetLevel made(const Asked& asked, BudgetSolver& solver, const LadderVisitor& visitor,
                     const Progress& progress, StageClock& clock) const;
    BudgetReport asReport(const Asked& asked, const Budget& budget) const;

    std::vector<Asked> asked_;
    TopologyLimits limits_;
    std::vector<StepMesh> steps_;
    std::optional<std::int64_t> wholeTriangles_;
    std::shared_ptr<const TriangleMesh> input_;
    StepOrder order_;
    std::optional<double> level0ToInput_;  // no point of either is farther from the other
};

}  // namespace isowave::lod
