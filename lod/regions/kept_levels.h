// The fields of the levels that coarser ones keep in places, and the blend of them into a coarser one.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "lod/regions/fade.h"
#include "lod/regions/local_levels.h"

namespace isowave::lod {

// A level's field with regions in it, on the lattice of the finest region that meets it.
struct RegionBlend {
    BSplineField field;
    LocalLevels levels;
    int refine =
        1;  // samples of the lattice's voxels: none of the levels is sampled more coarsely than it was
    RegionSummary summary;  // its control points
};

// What a level draws: its field; its mesh's samples of a voxel; parts and cavities below `smallest` are specks, world units^3.
struct DrawnLevel {
    int step = 0;
    BSplineField field;
    int refine = 1;
    double smallest = 0;
};

// By the step that they keep.
using RegionsByStep = std::map<int, std::vector<FadingRegion>>;

class KeptLevels {
  public:
    explicit KeptLevels(const StepOrder& order) : order_(order) {}

    // Shares the field's memory.
    void remember(DrawnLevel level);

    // Nothing where no region is finer than the level, or where those that are change nothing. REQUIRES: remember() has seen the levels
    // of all finer regions.
    std::optional<RegionBlend> blended(const DrawnLevel& own, const RegionsByStep& regions,
                                       const Progress& progress) const;

  private:
    StepOrder order_;
    std::map<int, DrawnLevel> kept_;  // by step
};

}  // namespace isowave::lod
