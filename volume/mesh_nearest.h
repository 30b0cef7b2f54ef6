// Exact distances to a triangle soup: a bounding volume hierarchy, asked point by point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "volume/triangle_mesh.h"
#include "volume/vdb.h"

namespace isowave {

// Boxes around halves of the triangles, split at the median of their centres along the longest axis that
// these span, until at most kInLeaf are left. A complete binary tree: node i has children 2i + 1 and 2i + 2,
// all leaves lie equally deep, and its shape depends on the number of triangles alone, so that halves are
// built in parallel.
class TriangleHierarchy {
  public:
    // REQUIRES: at least one triangle.
    TriangleHierarchy(const std::vector<openvdb::Vec3d>& points, const std::vector<Triangle>& triangles);

    struct Nearest {
        double squared;         // squared distance
        std::int64_t triangle;  // as the hierarchy numbers them
    };

    // The nearest triangle, or `bound` itself where none is nearer. Exact to rounding in double; a bound that
    // is nearly right makes it fast.
    Nearest nearest(const openvdb::Vec3d& point, Nearest bound) const;

    // From point to one triangle: a good bound if it was nearest to a neighbouring point.
    Nearest distanceTo(std::int64_t triangle, const openvdb::Vec3d& point) const;

  private:
    static constexpr std::size_t kInLeaf = 2;

    using Corners = std::array<openvdb::Vec3d, 3>;
    struct Range {  // node's triangles
        std::size_t node, begin, end;
        std::size_t middle() const { return begin + (end - begin) / 2; }
        Range left() const { return {2 * node + 1, begin, middle()}; }
        Range right() const { return {2 * node + 2, middle(), end}; }
    };
    bool isLeaf(const Range& range) const { return range.node >= firstLeaf_; }
    void build(const Range& range);

    std::vector<Corners> corners_;
    std::vector<openvdb::BBoxd> boxes_;
    std::size_t firstLeaf_ = 0;
};

}  // namespace isowave
