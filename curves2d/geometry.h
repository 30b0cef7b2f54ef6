// Vector algebra and areas of the plane; the types are those of isowave/curves.h.
#pragma once

#include <cmath>
#include <cstddef>

#include "isowave/curves.h"

namespace isowave::curves2d {

inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
inline double cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }
inline double length(Point a) { return std::hypot(a.x, a.y); }

// The area that a ring surrounds, positive when it runs counter-clockwise (y pointing up). The products are taken
// relative to the first point: relative to the origin they lose digits for rings that lie far from it.
inline double signedArea(const Ring& ring) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < ring.size(); ++i)
        twice += cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
    return twice / 2;
}

}  // namespace isowave::curves2d
