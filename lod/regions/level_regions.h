// All regions of a ladder, those that were asked for and those that a tolerance needs, and what levels they keep.
#pragma once

#include <optional>

#include "lod/regions/adaptive_regions.h"
#include "lod/regions/fine_regions.h"

namespace isowave::lod {

class LevelRegions {
  public:
    // Reads meshes. Throws InputError as regionShapeOf() does.
    LevelRegions(const LevelOptions& options, const StepOrder& order, const Progress& progress);

    // Whether coarser levels need what the step draws. Level 0 is always needed.
    bool keeps(int step) const;

    // To be called for every level that is drawn, finest first, with its mesh. Throws InputError for a region beside level 0.
    void see(const DrawnLevel& level, const TriangleMesh& mesh, const Progress& progress);

    // One level's regions: what is tried, and changed where the mesh is too far from level 0.
    struct Choice {
        RegionsByStep asked;
        AdaptiveRegions::Kept kept;
        AdaptiveSummary summary;  // of the last mesh that was measured
    };
    Choice choiceFor(const DrawnLevel& own) const;
    std::optional<RegionBlend> blended(const DrawnLevel& own, const Choice& choice,
                                       const Progress& progress) const;
    // Measures the mesh of a blend. Whether another one is to be made.
    bool widen(Choice& choice, const TriangleMesh& mesh, const Progress& progress) const;
    // Of the triangles of a blend, as LocalLevels::collapse() has it. REQUIRES: level 0 has been seen.
    double deviation() const { return adaptive_ ? adaptive_->deviation() : 0; }

  private:
    std::vector<int> keptSteps_;  // of the regions that were asked for, ascending
    StepOrder order_;
    FineRegions fine_;
    std::optional<AdaptiveRegions> adaptive_;
    KeptLevels levels_;
};

}  // namespace isowave::lod
