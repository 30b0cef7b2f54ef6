// Exact distances to a triangle soup: a bounding volume hierarchy, asked point by point.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/halving_tree.h"
#include "isowave/mesh.h"
#include "volume/vdb.h"

namespace isowave {

// Boxes around halves of the triangles, split at the median of their centres along the longest axis that
// these span, until at most kInLeaf are left. Corners are copied leaf by leaf, boxes are double: 120 to
// 168 bytes a triangle for the fastest of queries, of which a distance field takes millions. TriangleBoxes
// (simplify/boxes.h) takes 16 to 28 bytes for meshes of tens of millions of triangles, which are asked less
// often.
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

    // Where on one triangle the point nearest to `point` lies.
    openvdb::Vec3d footOn(std::int64_t triangle, const openvdb::Vec3d& point) const;

    // (b - a) x (c - a) of one triangle: 0 where it is degenerate.
    openvdb::Vec3d areaNormal(std::int64_t triangle) const;

    // From point to one triangle: a good bound if it was nearest to a neighbouring point.
    Nearest distanceTo(std::int64_t triangle, const openvdb::Vec3d& point) const;

  private:
    static constexpr std::size_t kInLeaf = 2;

    using Corners = std::array<openvdb::Vec3d, 3>;
    using Range = HalvingTree::Range;  // of triangles
    void divide(const Range& range);
    void bound(const Range& range);

    std::vector<Corners> corners_;
    std::vector<openvdb::BBoxd> boxes_;
    HalvingTree tree_;
};

}  // namespace isowave
