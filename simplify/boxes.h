// A hierarchy of boxes around triangles, for nearest points. It takes little memory: levels of large images
// have tens of millions of triangles.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/halving_tree.h"
#include "isowave/mesh.h"

namespace isowave {

// Boxes around halves of the triangles, split at the median of their centres along the longest axis that
// these span, until at most kInLeaf are left. Boxes are float32, rounded outwards.
// Memory: 16 to 28 bytes a triangle beside the mesh. CGAL's AABB_tree takes 80 (a node of 64, a primitive of
// 16) and, since it does not visit the nearer box first, a k-d tree of all triangles for a first guess.
class TriangleBoxes {
  public:
    // The mesh must outlive the boxes. REQUIRES: at least one triangle; finite points.
    explicit TriangleBoxes(const TriangleMesh& mesh);

    struct Nearest {
        double squared = std::numeric_limits<double>::infinity();  // squared distance
        std::uint32_t triangle = 0;
    };
    // squaredTo(triangle) is the squared distance from p to it, called for those that may be nearest. The
    // search ends with the first one that is at most sqrt(enough) away.
    template <class SquaredTo>
    Nearest nearest(const Point& p, const SquaredTo& squaredTo, double enough = 0) const;

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
    using Range = HalvingTree::Range;  // of triangles
    void divide(const std::vector<std::array<float, 3>>& centres, const Range& range);
    void bound(const TriangleMesh& mesh, const Range& range);
    Box boxOf(const TriangleMesh& mesh, const Range& range) const;

    std::vector<std::uint32_t> order_;  // triangles, leaf after leaf
    std::vector<Box> boxes_;
    HalvingTree tree_;
};

template <class SquaredTo>
TriangleBoxes::Nearest TriangleBoxes::nearest(const Point& p, const SquaredTo& squaredTo,
                                              double enough) const {
    Nearest best;
    double bound = best.squared;  // 0 when the search is over: no box is nearer than that
    tree_.nearestFirst(
        bound, [&](std::size_t box) { return boxes_[box].squaredDistanceTo(p); },
        [&](const Range& leaf) {
            for (std::size_t i = leaf.begin; i < leaf.end; ++i)
                if (const double found = squaredTo(order_[i]); found < best.squared)
                    best = {found, order_[i]};
            bound = best.squared <= enough ? 0 : best.squared;
        });
    return best;
}

}  // namespace isowave
