// A mesh that is fine in regions and coarse elsewhere: which level each place follows, and a collapse that makes the
// triangles follow it.
//
// The mesh comes as a blended field was sampled, r times along each axis of the finest level's voxel, everywhere. A level that is n
// steps coarser has voxels 2^n times as large, 2^k in the mean (geometric) of the axes, k = n / 3, and a mesh of it that is sampled s
// times a voxel has about (s / (2^k r))^2 of these triangles. So the triangles that follow this level are collapsed to that share, level
// by level, while all points that follow another one stay. Where a level fades into one that is k' coarser, the share is the mean
// (geometric) of both: 2^-k' of the finer one's.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "isowave/ladder.h"
#include "lod/regions/fade.h"

namespace isowave::lod {

// How often each axis has been halved since level 0.
using Halvings = std::array<int, 3>;

class LocalLevels {
  public:
    struct Stage {
        Halvings halvings{};
        double smallest = 0;  // parts and cavities below that are specks there, world units^3
        std::shared_ptr<const FadeWeights> weights;
    };
    // regions: finest first, all finer than `own`, whose weights say nothing.
    LocalLevels(std::vector<Stage> regions, Stage own);

    enum class Place : char { inside, fading, outside };  // as RegionSummary has them
    // The worst of a triangle's corners.
    std::vector<Place> placesOf(const TriangleMesh& mesh, const Progress& progress) const;

    // By point: what is a speck there.
    std::vector<double> smallestAt(const TriangleMesh& mesh, const Progress& progress) const;

    // sampled, wanted: samples of a voxel along each axis: of the mesh, of the finest region's voxels; and to be, of each place's
    // own level's. deviation: CollapseOptions', world units, 0: any. Where there is one, what fades out has the coarser level's share: both
    // levels are near enough there. REQUIRES: as collapseByQuadrics(); sampled / wanted is whole.
    void collapse(TriangleMesh& mesh, int sampled, int wanted, double deviation,
                  const Progress& progress) const;

    // Of a stage's control points, the own level's being the last one: those that the mesh depends on, where its weight is
    // above 0 and no finer stage's is 1.
    std::int64_t pointsOf(std::size_t stage, const BSplineField& field, const Progress& progress) const;

  private:
    struct PointPlace {
        char stage = 0;  // the finest that the surface depends on there
        bool inside = false;
    };
    std::vector<PointPlace> pointPlaces(const TriangleMesh& mesh, const Progress& progress) const;
    void collapseTo(TriangleMesh& mesh, std::size_t stage, bool inside, double share, double deviation,
                    const Progress& progress) const;

    std::vector<Stage> stages_;  // the own level is the last one
};

// The triangles that are inside, or all others; of the points those that they use.
TriangleMesh partOf(const TriangleMesh& mesh, const std::vector<LocalLevels::Place>& places, bool inside);

}  // namespace isowave::lod
