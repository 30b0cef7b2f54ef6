// The boundary of a triangle soup modulo 2, as simple loops.
#pragma once

#include <vector>

#include "volume/repair/edges.h"

namespace isowave::repair {

struct BoundaryEdge {
    Index from, to;  // the direction that its triangles lack
    bool used = false;
};

// The edges of odd use.
std::vector<BoundaryEdge> boundaryOf(const std::vector<EdgeUse>& uses);

// Simple loops, each as its points in order. At every point an edge that leads away is preferred, so that
// loops run with the surface's orientation wherever it has one. Time and memory are linear in the edges and
// points but for the sort: every edge is walked once, taken off the path once and passed by a cursor twice.
using Loop = std::vector<Index>;
std::vector<Loop> loopsOf(std::vector<BoundaryEdge> edges, std::size_t points, const Progress& progress);

}  // namespace isowave::repair
