// Points that are equal to the last digit made one, as a reader of STL, which has no indices, must.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

// The points that are no copies, by their index, in order; and for each point which of them it is a copy of or is itself:
// points[i] equals points[firsts[which[i]]] (-0 equals 0). One pass, whatever the points.
struct DistinctPoints {
    std::vector<std::uint32_t> firsts, which;
};
DistinctPoints distinctPoints(std::span<const Point> points);

}  // namespace isowave
