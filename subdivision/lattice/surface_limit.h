// Limit positions of surfaces on the triangular lattice: where subdivision without end takes each node.
//
//   Butterfly    the nodes themselves
//   Loop-like    inside: with P's alpha and gamma, w = 2 alpha/(1 - 2 gamma) of each neighbour and 1 of the node, over
//                1 + 6 w (Loop: 1/2 and 1/12), as limit_mask.h finds from the mask; along a side (1, 4, 1)/6, its cubic
//                B-spline; corners stay. The star of a node beside a side lies on the patch, so its rule is that of inside.
#pragma once

#include <vector>

#include "subdivision/lattice/surface.h"

namespace isowave::subdivision {

class SurfaceLimit {
  public:
    // Throws InputError as limitMask() does: of the pairs of loop-like some do not converge.
    explicit SurfaceLimit(const SurfaceScheme& scheme);
    SurfaceField of(const SurfaceField& field) const;

  private:
    std::vector<SurfaceFilters::Tap> tapsAt(const Patch& patch, Node node) const;

    bool keepsNodes_;
    std::vector<SurfaceFilters::Tap> inside_;  // offsets from the node
};

}  // namespace isowave::subdivision
