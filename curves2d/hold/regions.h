// The plane cut into regions by curves: parts, holes, and the world around them, row by row.
//
// A region is named by the ring directly around it: a part by its outer ring, a hole by its own, the world by kWorld.
// Places and lengths are pixels of level 0; rows lie at y = spacing * j.
#pragma once

#include <cstdint>
#include <vector>

#include "curves2d/geometry.h"

namespace isowave::curves2d {

class Regions {
  public:
    static constexpr std::int32_t kWorld = -1;

    // pixel: of the curves' lattice, in pixels of level 0. The curves may go afterwards.
    Regions(const Curves& curves, double pixel, double spacing);

    std::int32_t count() const { return static_cast<std::int32_t>(inside_.size()); }
    // Of a region, kWorld included.
    bool inside(std::int32_t region) const {
        return region != kWorld && inside_[static_cast<std::size_t>(region)];
    }
    // Without what lies in its holes or, for holes, without the islands. REQUIRES: region != kWorld.
    double area(std::int32_t region) const { return area_[static_cast<std::size_t>(region)]; }
    // The region of the point (spacing * i, spacing * j).
    std::int32_t at(std::int32_t i, std::int32_t j) const;

    struct Cell {
        std::int32_t i, j;
    };
    // The lattice points (spacing * i, spacing * j) of a region, row by row. REQUIRES: region != kWorld.
    std::vector<Cell> points(std::int32_t region) const;

  private:
    friend class Overlaps;
    struct Crossing {
        double x;
        std::int32_t row, ring, after;  // after: the region to its right
    };

    double spacing_;
    std::vector<char> inside_;
    std::vector<double> area_;
    std::vector<Crossing> crossings_;       // by row, then x
    std::vector<std::uint32_t> begin_;      // of each region in stretches_
    std::vector<std::uint32_t> stretches_;  // crossings behind which a region lies, region by region
};

// How regions of one set of curves lie over those of another, of the same kind (inside or not).
class Overlaps {
  public:
    struct Overlap {
        std::int32_t over, under;
        double area;
    };
    // REQUIRES: equal spacing.
    Overlaps(const Regions& over, const Regions& under);
    // By `over`, then `under`.
    const std::vector<Overlap>& all() const { return overlaps_; }

  private:
    std::vector<Overlap> overlaps_;
};

// The regions of `curves` that are more than `before` had: those that lie over no region of their kind that a larger one
// does not own already. What is left has at most as many parts and holes as `before`. Ascending.
std::vector<std::int32_t> excessRegions(const Regions& curves, const Regions& before);

// Without the given rings and all that lies in them.
Curves withoutRings(const Curves& curves, const std::vector<std::int32_t>& rings);

}  // namespace isowave::curves2d
