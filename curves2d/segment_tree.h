// Segments in a tree of boxes: nearest distance, and which segments a box meets.
#pragma once

#include <cstdint>
#include <vector>

#include "curves2d/geometry.h"

namespace isowave::curves2d {

double squaredDistance(Point p, const Box& box);
double squaredDistance(Point p, const Segment& s);

class SegmentTree {
  public:
    explicit SegmentTree(std::vector<Segment> segments);

    // Infinite for an empty tree. near: larger distances need not be told apart, so less is searched.
    double distance(Point p, double near = INFINITY) const;

    // Calls f(index into the segments as they were given) for every one whose box meets `box`; stops when f
    // returns false.
    template <class F>
    void eachMeeting(const Box& box, const F& f) const {
        if (!nodes_.empty()) visit(0, box, f);
    }

  private:
    static constexpr std::size_t kLeafSize = 4;
    struct Node {
        Box box;
        std::uint32_t begin, end;  // of order_
        std::uint32_t right = 0;   // the second child; the first one follows the node; 0: a leaf
    };

    std::uint32_t build(std::uint32_t begin, std::uint32_t end);
    void nearest(std::uint32_t node, Point p, double& best) const;

    template <class F>
    bool visit(std::uint32_t at, const Box& box, const F& f) const {
        const Node& node = nodes_[at];
        if (!node.box.meets(box)) return true;
        if (node.right) return visit(at + 1, box, f) && visit(node.right, box, f);
        for (std::uint32_t i = node.begin; i < node.end; ++i) {
            const Segment& s = segments_[order_[i]];
            Box own;
            own.take(s.a);
            own.take(s.b);
            if (own.meets(box) && !f(order_[i])) return false;
        }
        return true;
    }

    std::vector<Segment> segments_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace isowave::curves2d
