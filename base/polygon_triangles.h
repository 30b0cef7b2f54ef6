// A polygon in space, planar or not, convex or not -> triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "isowave/mesh.h"

namespace isowave {

// Triangles as numbers of the polygon's corners, n - 2 of n, that run the way the polygon does. A polygon that its first
// corner sees whole, as every convex one, becomes the fan of that corner. Of others, up to 200 corners, comes the
// triangulation of least area (Klincsek 1980: "Minimal triangulations of polygonal domains"; n^3/6 steps), which of a planar
// polygon, holes cut in by a bridge included, is one without overlaps. Longer ones lose ears where they are planar, and are
// halved along short chords where they are not; n^2 steps.
// Corners may coincide: triangles of no area come of it. REQUIRES: at least three corners, all finite.
std::vector<std::array<std::uint32_t, 3>> trianglesOf(std::span<const Point> polygon);

}  // namespace isowave
