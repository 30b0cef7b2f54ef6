// Two fields on one lattice, blended by a weight that falls from 1 in a region to 0 outside it.
//
//   c      control points of a coarse level on its own lattice; P c: the same function on the fine lattice (knot insertion,
//          polygonize/knot_insertion.h). The two-scale relation of cubic B-splines is exact, so nothing is lost.
//   f      control points of the finer level; f = P c + Q d, d the details of all steps between them (E§4.2)
//   w      weight of a lattice point, 0 to 1
//
//   blend  b = w f + (1 - w) P c = P c + w Q d
//
// So blending is the synthesis with details faded out: all of them where w = 1, none where w = 0. (Levels that hold what is thin
// differ from the pyramid's by a correction of c and one of f; b then fades from one corrected field to the other.)
//
// F at x depends on the 64 control points around x, less than 2 voxels from it on each axis. Therefore w is 1 up to
// `margin` = 2 diagonals of a voxel beyond a box or a mesh, and falls to 0 over `width`, one voxel of the coarse level:
//
//   w = t^2 (3 - 2 t),   t = 1 - (distance - margin) / width, between 0 and 1
//
// Of several regions the largest weight counts.
//
// (1) In the region F is the finer level's, to the bit; farther than width + 2 margin from it, the coarse level's, to the bit of P c.
// (2) b is one field with one zero set, whatever f and P c are: there is no seam that could open.
// (3) The same bits for any number of threads.
#pragma once

#include <memory>
#include <vector>

#include "isowave/progress.h"
#include "lod/regions/region_distance.h"
#include "volume/field.h"

namespace isowave::lod {

struct FadingRegion {
    std::shared_ptr<const RegionDistance> region;  // on the lattice of the finer level
    double margin = 0;                             // world units, from 0 on
    double width = 1;                              // world units, above 0
};

// Two diagonals of a voxel, world units.
double marginOn(const openvdb::math::Transform& lattice);
// A region with that margin.
FadingRegion fading(std::shared_ptr<const RegionDistance> region, const openvdb::math::Transform& lattice,
                    double width);

class Fade {
  public:
    Fade(std::vector<FadingRegion> regions, const openvdb::math::Transform& lattice);

    double at(const openvdb::Coord& point) const;

    // The one weight of the 8^3 lattice points from `origin` on, 0 or 1; below 0 where they differ, or may.
    double ofBlock(const openvdb::Coord& origin) const;

    // Lattice points outside have weight 0.
    openvdb::CoordBBox box() const;

  private:
    std::vector<FadingRegion> regions_;
    double blockReach_;  // no point of a block is farther than this from its middle one
};

// Weights of lattice points; those that the blend needed are kept.
class FadeWeights {
  public:
    FadeWeights(Fade fade, const openvdb::math::Transform& lattice);

    // What the surface at a place (world) depends on: the least and the largest weight of the 64 control points around it.
    struct Range {
        double least = 0, most = 0;
    };
    class Reader;

    const Fade& fade() const { return fade_; }
    openvdb::FloatTree& known() { return known_; }

  private:
    Fade fade_;
    openvdb::math::Transform::ConstPtr lattice_;
    openvdb::CoordBBox box_;
    openvdb::FloatTree known_;  // active where the weight is known
};

// One a thread.
class FadeWeights::Reader {
  public:
    explicit Reader(const FadeWeights& weights) : weights_(&weights), accessor_(weights.known_) {}
    Range around(const Point& place) const;
    double at(const openvdb::Coord& point) const;

  private:
    const FadeWeights* weights_;
    openvdb::FloatGrid::ConstUnsafeAccessor accessor_;
};

struct Blend {
    BSplineField field;
    std::int64_t finePoints = 0;  // control points of the finer field with w > 0
    // Whether the surface of either field depends on what was blended in: somewhere w > 0 and f is not P c, and where w > 0 not all
    // control points of both have one sign (then neither is 0 there, the B-splines being positive).
    bool differs = false;
};

// coarse: P c. Where both have the same constant there is nothing to store; else a point is known (active) where one of the fields
// that count there knows it, and where the two differ under 0 < w < 1. weights: those of the blocks that were looked at are put
// in. REQUIRES: both on one lattice, with one K.
Blend blend(const BSplineField& coarse, const BSplineField& fine, FadeWeights& weights,
            const Progress& progress);

}  // namespace isowave::lod
