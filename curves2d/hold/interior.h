// What curves surround: whether a point lies inside, in which part, how far away the nearest curve is.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "curves2d/segment_tree.h"

namespace isowave::curves2d {

// Places and lengths are lattice coordinates of the curves.
class Interior {
  public:
    // The curves may go afterwards.
    explicit Interior(const Curves& curves);

    // The outer ring of the part that the point lies in; nothing outside. On a curve: one of the two.
    std::optional<std::int32_t> part(Point p) const;
    bool inside(Point p) const { return part(p).has_value(); }
    // To the nearest curve; distances above `near` need not be told apart.
    double distance(Point p, double near = INFINITY) const { return tree_.distance(p, near); }
    // To the nearest inside point: 0 inside.
    double away(Point p, double near = INFINITY) const { return inside(p) ? 0 : distance(p, near); }

    // Of a ring (0 .. rings - 1): the outer ring of its part.
    std::int32_t partOf(std::int32_t ring) const { return outer_[static_cast<std::size_t>(ring)]; }
    // Of the part that a ring belongs to, its holes left out.
    double partArea(std::int32_t ring) const { return area_[static_cast<std::size_t>(partOf(ring))]; }
    double largestPart() const { return largest_; }

  private:
    // A crossing of a curve with a lattice row; along a row the curves alternately go in and out.
    struct Crossing {
        Point at;
        std::int32_t ring;
    };

    void addCrossings(std::size_t segment);

    std::vector<Segment> segments_;
    std::vector<std::int32_t> ringOfSegment_;
    SegmentTree tree_;
    std::vector<Crossing> crossings_;  // row by row
    std::vector<std::int32_t> outer_;
    std::vector<double> area_;  // of outer rings less their holes
    double largest_ = 0;
};

}  // namespace isowave::curves2d
