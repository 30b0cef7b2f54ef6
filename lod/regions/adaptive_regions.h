// The regions that a tolerance asks for (LevelOptions::adaptive): of each level, where the surface needs a finer one.
//
//   M_k, F_k    the mesh and the field of level k as it is without regions; level 0's surface is the measure
//   N_k         cells, voxels of level k's lattice, in which level k is not good enough:
//                 - a sample of M_k is farther than the tolerance from M_0, or one of M_0 farther from M_k
//                 - a corner lies inside one of F_k, F_0 and outside the other, and farther than the tolerance from M_0
//   R_l         where coarser levels keep level l: R_0 = N_1, R_l = N_(l+1) and the cells that hold R_(l-1)
//
// (1) R_0 lies in R_1, that in R_2, and so on: a place follows the coarsest level up to which all are good there.
// (2) Outside R_l the levels 1 to l + 1 are good, so what fades from level l to l + 1 there is a mixture of two good fields.
// (3) R_l does not depend on the levels that are asked for, nor on the number of threads.
//
// A blend's triangles are collapsed to the local level's number, and may be farther away than those of the level were. So a blended
// mesh is measured again, and where a sample is too far, its cell follows the next finer level (at level 0: those around it, too).
//
// An octree's cells that are split where a field is not linear (Frisken et al. 2000: adaptively sampled distance fields) would need
// meshes that are stitched between cells of different sizes. The levels of the pyramid are one field with one zero set.
#pragma once

#include <optional>
#include <vector>

#include "isowave/ladder.h"
#include "lod/regions/cell_region.h"
#include "lod/regions/far_places.h"
#include "lod/regions/kept_levels.h"

namespace isowave::lod {

class AdaptiveRegions {
  public:
    AdaptiveRegions(const Length& tolerance, const StepOrder& order);

    // To be called for every level, level 0 first, with what it draws; its mesh may be empty but level 0's.
    void see(const DrawnLevel& level, const TriangleMesh& mesh, const Progress& progress);

    // R_0, R_1, ... of one level: those that are finer. An empty one keeps nothing.
    using Kept = std::vector<Cells>;
    // REQUIRES: all levels up to this step have been seen.
    Kept keptFor(int step) const;
    // Each faded out over one voxel of the next coarser level.
    RegionsByStep regionsOf(const Kept& kept) const;

    // That a collapse may add to the fields' own, root mean square, world units. REQUIRES: level 0 has been seen.
    double deviation() const { return kCollapsed * tolerance_; }

    // Measures a blended mesh, both ways, and widens what is kept where it is too far from level 0. Whether there is
    // anything new to try.
    bool widen(Kept& kept, const TriangleMesh& blended, AdaptiveSummary& summary,
               const Progress& progress) const;

  private:
    static constexpr double kCollapsed = 0.3;  // of the tolerance

    struct Seen {
        openvdb::math::Transform::ConstPtr lattice;
        Cells bad;  // N_k; none of level 0
    };
    const openvdb::math::Transform& latticeOf(std::size_t level) const { return *seen_[level].lattice; }
    std::array<int, 3> halvingsTo(std::size_t level) const;  // from the level before
    struct Apart {
        std::vector<FarPlace> places;
        double largest = 0;  // with howFar: distance of a sample
    };
    Apart apart(const TriangleMesh& mesh, bool howFar, const Progress& progress) const;
    Cells badCells(std::size_t level, const BSplineField& field, const TriangleMesh& mesh,
                   const Progress& progress) const;
    std::vector<openvdb::Coord> turned(std::size_t level, const BSplineField& field,
                                       const Progress& progress) const;
    std::size_t followedAt(const Kept& kept, const Point& place) const;
    bool add(const Kept& before, Kept& kept, const Point& place) const;

    Length asked_;
    StepOrder order_;
    double tolerance_ = 0;  // world units, from level 0 on
    std::optional<SampledSurface> level0_;
    BSplineField field0_;
    std::vector<Seen> seen_;  // by level
};

}  // namespace isowave::lod
