// What the meshes of `isowave lod` are called.
#pragma once

#include <string>
#include <vector>

#include "io/mesh/write.h"
#include "isowave/ladder.h"

namespace isowave::tools {

class MeshNames {
  public:
    // folder: the name of the folder that the meshes go to, which their own names start with.
    MeshNames(std::string folder, MeshFormat format, const LevelOptions& levels,
              const BudgetOptions& budgets);

    // part_L2.ply; with --steps part_s5.ply
    std::string ofLevel(const LevelReport& level) const;
    // part_T20000.ply, part_R0.01.ply, part_D0.5.ply; part_chosen.ply where only the topology is limited.
    std::string ofBudget(const BudgetReport& budget) const;
    // part.html, the page of --view.
    std::string ofPage() const;
    // part_lods.glb, all levels in one file.
    std::string ofLods() const;
    // "L2" of part_L2.ply: what the name of a mesh says besides the folder's.
    std::string suffixOf(const std::string& name) const;
    // Of all steps that may be reached, and of all budgets.
    std::vector<std::string> all() const;

  private:
    std::string named(const std::string& suffix) const;
    // Of a level, or of a step where steps are asked for.
    std::string numbered(int number) const;

    std::string folder_;
    MeshFormat format_;
    LevelOptions levels_;
    BudgetOptions budgets_;
};

}  // namespace isowave::tools
