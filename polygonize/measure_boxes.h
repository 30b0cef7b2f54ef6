// Boxes around triangles, for nearest points. Small: levels of large images have tens of millions of triangles.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "volume/triangle_mesh.h"

namespace isowave {

// Boxes around halves of the triangles, split at the median of their centres along the longest axis that these span,
// until at most kInLeaf are left. A complete binary tree: node i has children 2i + 1 and 2i + 2; its shape depends on the
// number of triangles alone. Boxes are float32, rounded outwards.
// Memory: 16 to 28 bytes a triangle beside the mesh. CGAL's AABB_tree takes 80 (a node of 64, a primitive of 16) and, since
// it does not visit the nearer box first, a k-d tree of all triangles for a first guess.
class TriangleBoxes {
  public:
    // The mesh must outlive the boxes. REQUIRES: at least one triangle; finite points.
    explicit TriangleBoxes(const TriangleMesh& mesh);

    struct Nearest {
        double squared = std::numeric_limits<double>::infinity();  // squared distance
        std::uint32_t triangle = 0;
    };
    // squaredTo(triangle) is the squared distance from p to it, called for those that may be nearest.
    template <class SquaredTo>
    Nearest nearest(const Point& p, const SquaredTo& squaredTo) const;

  private:
    static constexpr std::size_t kInLeaf = 4;

    struct Box {
        std::array<float, 3> low, high;
        double squaredDistanceTo(const Point& p) const {
            double sum = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const double below = low[a] - p[a], above = p[a] - high[a];
                const double beyond = below > 0 ? below : above > 0 ? above : 0;
                sum += beyond * beyond;
            }
            return sum;
        }
    };
    struct Range {  // a node's triangles
        std::size_t node = 0, begin = 0, end = 0;
        std::size_t middle() const { return begin + (end - begin) / 2; }
        Range left() const { return {2 * node + 1, begin, middle()}; }
        Range right() const { return {2 * node + 2, middle(), end}; }
    };
    bool isLeaf(const Range& range) const { return range.node >= firstLeaf_; }
    void build(const TriangleMesh& mesh, const std::vector<std::array<float, 3>>& centres,
               const Range& range);
    Box boxOf(const TriangleMesh& mesh, const Range& range) const;

    std::vector<std::uint32_t> order_;  // triangles, leaf after leaf
    std::vector<Box> boxes_;
    std::size_t firstLeaf_ = 0;
};

template <class SquaredTo>
TriangleBoxes::Nearest TriangleBoxes::nearest(const Point& p, const SquaredTo& squaredTo) const {
    // invariant: nodes on the stack and below `at` are all that may hold a nearer triangle. One node a level waits.
    std::array<std::pair<Range, double>, 64> stack;
    std::size_t waiting = 0;
    Nearest best;
    Range at{0, 0, order_.size()};
    double distance = boxes_[0].squaredDistanceTo(p);
    while (true) {
        if (distance < best.squared) {
            if (!isLeaf(at)) {
                Range near = at.left(), far = at.right();
                double toNear = boxes_[near.node].squaredDistanceTo(p);
                double toFar = boxes_[far.node].squaredDistanceTo(p);
                if (toFar < toNear) {
                    std::swap(near, far);
                    std::swap(toNear, toFar);
                }
                if (toFar < best.squared) stack[waiting++] = {far, toFar};
                at = near;
                distance = toNear;
                continue;
            }
            for (std::size_t i = at.begin; i < at.end; ++i)
                if (const double found = squaredTo(order_[i]); found < best.squared)
                    best = {found, order_[i]};
        }
        if (waiting == 0) return best;
        --waiting;
        at = stack[waiting].first;
        distance = stack[waiting].second;
    }
}

}  // namespace isowave
