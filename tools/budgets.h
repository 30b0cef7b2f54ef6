// lod --triangles, --ratio, --tolerance, --max-genus, --min-component: meshes by budget instead of by level.
#pragma once

#include <string>
#include <vector>

#include "simplify/budget.h"
#include "tools/input.h"
#include "tools/output.h"

namespace isowave::tools {

// Collects the meshes of all steps, then makes and writes one mesh a budget:
// part_T20000.ply, part_R0.01.ply, part_D0.5.ply; part_chosen.ply where only the topology is limited.
class Budgets {
  public:
    // Throws UsageError for what does not go together.
    Budgets(const Settings& settings, std::string name, MeshFormat format);

    bool wanted() const { return !asked_.empty(); }
    std::vector<std::string> fileNames() const;
    // REQUIRES: steps in ascending order, step 0 first; the mesh is not empty.
    void add(int step, const BSplineField& field, const TriangleMesh& mesh, const MeshTopology& topology);
    // One entry a budget, for the report. `input` is what messages call the solid.
    Json write(OutputFolder& out, Space space, const std::string& input, Console& console, StageClock& clock);

    static std::string tableOf(const Json& budgets, const std::string& unit);

  private:
    struct Asked {
        Budget budget;
        double ratio = 0;  // of level 0's triangles, where not 0
        std::string suffix;
    };
    std::string fileName(const Asked& asked) const;
    Json written(const Asked& asked, BudgetChooser& chooser, OutputFolder& out, Space space, Console& console,
                 StageClock& clock) const;

    std::string name_;
    MeshFormat format_;
    std::vector<Asked> asked_;
    TopologyLimits limits_;
    std::vector<StepMesh> steps_;
    std::int64_t finestTriangles_ = 0;
};

}  // namespace isowave::tools
