// Where subdivision without end takes a node of a regular lattice: a mask over the coarse nodes, from the two-scale
// relation alone.
//
// P's mask p makes of a single 1 the function F with
//   (1) F(x) = sum over the fine nodes k of p[k] F(2x - k),     sum over the coarse nodes t of F(x - t) = 1,
// and of coarse values c the surface  S(x) = sum of c_t F(x - t). The coarse node t stands for the place t + m with
//   (2) m = (sum of k p[k]) / (2 or 4), the centre of gravity of F: then S reproduces linear functions, and points that
//       lie evenly on a straight line are their own limits.
// m is 0 for a mask about its vertex node (cubic, Loop), 1/2 for one about the middle of an edge (Chaikin).
//   F at the nodes     (1) there is an eigenvector of the eigenvalue 1:  F(i) = sum of p[2i - j] F(j)
//   F at m + nodes     m is dyadic, and (1) halves its denominator
// All in rationals.
#pragma once

#include <string>

#include "subdivision/filters/construct.h"

namespace isowave::subdivision {

// Empty when subdivision by `mask` converges to continuous surfaces for all coarse values; else why not, or that it is not
// known to. Two conditions: the taps that make each fine node add up to 1, exactly; and the differences of neighbours
// shrink. With a_k the mask iterated k times, differences over any edge e and the coarse ones obey
//   |d_k| <= R sum over t of |a_k(i - 2^k t) - a_k(i + e - 2^k t)| |d_0|,
// R the steps across the nodes t that take part; a factor below 1 for one k suffices (Dyn, "Subdivision schemes in
// computer-aided geometric design", 1992). REQUIRES: a mask on the line or on the triangular lattice.
std::string whyNoLimit(const Mask& mask);

// The weights w of the limit position of the coarse node 0:  S(m) = sum of w[t] c_t. They add up to 1.
// Throws InputError, naming the mask: whyNoLimit(), or an m that is not dyadic.
Diagram limitMask(const Mask& mask);

}  // namespace isowave::subdivision
