// The regions of a ladder (LevelOptions::fine): remembers the fields of the levels that they keep, and blends them into those of
// coarser levels.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lod/regions/fade.h"
#include "lod/regions/local_levels.h"

namespace isowave::lod {

// The steps of the levels that regions keep, ascending.
std::vector<int> stepsOf(const std::vector<FineRegion>& regions, const StepOrder& order);

// A level's field with regions in it, on the lattice of the finest region that meets it.
struct RegionBlend {
    BSplineField field;
    LocalLevels levels;
    int refine =
        1;  // samples of the lattice's voxels: none of the levels is sampled more coarsely than it was
    RegionSummary summary;  // its control points
};

class FineRegions {
  public:
    // Reads meshes. Throws InputError as regionShapeOf() does.
    FineRegions(const std::vector<FineRegion>& regions, const StepOrder& order, const Progress& progress);

    // Throws InputError for a region that lies beside the solid altogether. solid: the box around level 0.
    void requireWithin(const PointBox& solid) const;

    // To be called for every level, finest first, with what it draws; kept if a region asks for it. refine: its mesh's; smallest:
    // parts and cavities below that are specks, world units^3.
    void remember(int step, const BSplineField& field, int refine, double smallest, const Progress& progress);

    // own: the field of step's level, with its refine and smallest. Nothing where no region is finer, or where those that are
    // change nothing. REQUIRES: remember() has seen the levels of all finer regions.
    std::optional<RegionBlend> blended(int step, const BSplineField& own, int refine, double smallest,
                                       const Progress& progress) const;

  private:
    struct Kept {
        BSplineField field;
        int refine = 1;
        double smallest = 0;
        std::vector<std::shared_ptr<const RegionDistance>> regions;
    };
    std::vector<RegionShape> shapes_;
    StepOrder order_;
    std::map<int, Kept> kept_;  // by step
};

}  // namespace isowave::lod
