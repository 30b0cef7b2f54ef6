// A triangular piece and a surface near it -> a bound of how far the piece is from the surface, where the surface is a graph over
// it. A piece may lie over any number of the surface's triangles, so flat parts need no halving.
//   column  all points whose foot on the piece's plane lies in the piece
//   height  of a point over that plane
//
// From the triangle `seed`, all triangles are visited that can be reached over edges that meet the column; all must face as the
// piece does. Then the surface covers the piece: what it covers is closed, and open within the piece, since around a point of
// the surface in the column all triangles are visited, and they face one way. So every point of the piece has one of the
// surface above or below, no farther than the largest height in the column. That is one of a corner of a visited triangle cut
// off at the column.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

class GraphBound {
  public:
    // The mesh must outlive this. Edges of other than two triangles that run opposite ways are borders, over which nothing is
    // reached.
    explicit GraphBound(const TriangleMesh& mesh);

    // No point of the piece is farther from the surface; nothing where that cannot be shown so, or is more than `enough`.
    std::optional<double> over(const std::array<Vec3, 3>& piece, std::uint32_t seed, double enough) const;

  private:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};
    const TriangleMesh& mesh_;
    std::vector<std::array<std::uint32_t, 3>>
        across_;  // by triangle and side (k to k+1): the triangle beyond
};

}  // namespace isowave
