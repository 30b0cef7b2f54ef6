// The iso-value at which a level's surface is taken: 0, unless it is chosen to keep the volume or the thin
// parts of level 0. F is negative inside, so a positive iso-value makes the solid thicker.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "isowave/progress.h"
#include "volume/field.h"

namespace isowave {

// An iso-value stays within this share of K. Nearer to K the level set no longer follows the surface but the
// ends of the band, where the field is cut off to ±K, and the ripple there (4 % of K is common) becomes
// surface.
inline constexpr double kIsoLimit = 0.75;

// ---- the volume of another level

struct VolumeMatch {
    double iso = 0;
    double volume = 0;    // there
    int evaluations = 0;  // of volumeAt
};

// The iso-value in [-limit, limit] at which volumeAt(iso) is `target` to `tolerance` (relative). volumeAt
// grows with iso, being the volume of { F < iso }; small steps (a speck that begins to count, a cell whose
// pattern changes) do no harm but may leave more than the tolerance. Where the target lies beyond the limit:
// the limit. A bracket grows from 0 by secants; TOMS 748 (Alefeld, Potra and Shi 1995) closes it. 4 to 8
// evaluations.
// REQUIRES: target > 0, tolerance > 0.
VolumeMatch isoOfVolume(const std::function<double(double iso)>& volumeAt, double target, double limit,
                        double tolerance = 1e-5);

// ---- thin parts

// Points in the middle of everything thin in a solid: of each run of lattice points inside, along each axis,
// that is short and leaves the solid through faces that look away from each other. Walls, sheets, struts,
// rods have them; edges, corners and what is thick have not.
class ThinParts {
  public:
    // A run counts when it is at most this long in voxels of the level that is asked about: thicker walls
    // keep their middle at any level.
    static constexpr double kThin = 2;
    // and when the cosine between the outward normals at its ends is at most this (135 degrees): the two
    // sides of a right-angled edge make 0.
    static constexpr double kOpposite = -0.7;
    // Of so many runs, evenly chosen, samples are made.
    static constexpr std::size_t kMostSamples = 200'000;
    // The share that --protect-thin keeps. The last hundredth is places where walls meet and bend; to keep
    // nine tenths of it, too, asks for half as much thickening again (docs/topology.md).
    static constexpr double kShare = 0.99;

    // finest: the field of step 0.
    explicit ThinParts(const BSplineField& finest, const Progress& progress = {});

    std::size_t size() const { return samples_.size(); }

    // F, latticeInterpolated(), at the samples that are thin for a level and the heart of what is thin,
    // ascending. Rims of walls and ends of rods, up to one voxel of the level wide, are left out: they draw
    // back at every level, and nothing tears by that.
    // level: a step of the same solid, with knots inserted as often as its mesh will have. spacing: of the
    // step, before that.
    std::vector<double> valuesOn(const BSplineField& level, const openvdb::Vec3d& spacing,
                                 const Progress& progress = {}) const;

  private:
    // Directions and lengths are in world units along the lattice's axes, which are taken to be orthogonal.
    struct Sample {
        openvdb::Vec3d at{0.0};      // index space of the finest field
        openvdb::Vec3d normal{0.0};  // of the wall
        int axis = 0;
        double length = 0;  // of the run
    };
    bool isHeart(const Sample& sample, const openvdb::Vec3d& levelSpacing) const;
    bool goesOn(const Sample& sample, const openvdb::Vec3d& direction,
                const openvdb::Vec3d& levelSpacing) const;

    openvdb::math::Transform::ConstPtr transform_;  // of the finest field
    Shape::ConstPtr shape_;                         // its signs
    openvdb::Vec3d spacing_;
    std::vector<Sample> samples_;
};

// Of values as valuesOn() gives them: the share that is inside the surface F = iso; 1 where there are none.
double shareInside(const std::vector<double>& ascending, double iso);

// The least iso-value in [0, limit] at which `share` of them is inside; the limit where none is enough.
double isoThatKeeps(const std::vector<double>& ascending, double share, double limit);

}  // namespace isowave
