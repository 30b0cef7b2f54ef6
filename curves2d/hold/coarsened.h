// Curves sampled finer than need be -> the same with fewer points.
#pragma once

#include <cstdint>
#include <functional>

#include "curves2d/geometry.h"

namespace isowave::curves2d {

// Whether the square with corners sampling * (i, j) and sampling * (i + 1, j + 1) must keep its points.
using KeepsPoints = std::function<bool(std::int32_t i, std::int32_t j)>;

// Of the points inside squares of `sampling` lattice steps those are left out that lie in no square that `keeps` them: only
// the points on the squares' sides are left there. A square that more than one piece of a curve passes, or that one leaves
// by the side where it entered, keeps its points too. So a square without points holds one straight piece, from one of its
// sides to another, and rings stay simple, disjoint and nested as they were.
Curves coarsened(const Curves& curves, int sampling, const KeepsPoints& keeps);

}  // namespace isowave::curves2d
