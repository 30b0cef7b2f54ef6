// Any subdivision of a regular lattice becomes a multiresolution: A, B, Q from P, exactly.
// Bartels and Samavati (B): sections 2 and 7.
//
//   f fine values, c coarse values, d details:    c = A f,   d = B f,   f = P c + Q d.
//   P   column at coarse node t: mask.p shifted by 2t         A   row at t: a shifted by 2t
//   Q   columns at t: q[k] shifted by 2t                      B   rows at t: b[k] shifted by 2t
// with one detail k for each node of the unit cell that is not a vertex node (one on the line, three else).
//
// construct() proves what it returns, in rationals, for every pair of diagrams that overlap:
//   (1) AP = I     (2) BP = 0     (3) AQ = 0     (4) BQ = I
//
// The derivation, in four steps.
//   A      The row of least norm in a window around the vertex node with (1). It is the local least-squares fit of B
//          section 2: among all rows that reproduce c from P c, noise in f moves it least.
//   B, Q0  B and a first Q0 with B P = 0 and B Q0 = I, local, by the first of these that applies:
//            trivial  P interpolates (vertex nodes keep their value): B is the residual at an edge node, Q0 puts it back.
//            flip     On the line: b[1-o] = (-1)^o p[o],  q[1-o] = (-1)^o a[o].  The alternating signs make the
//                     products b.p cancel in pairs, and b.q = sum p[o] a[o] = 1.
//            tensor   On the quad lattice, a mask that is a product of two: products of the line's filters.
//            one tap  A left inverse A0 of P that reads one vertex node only, with weight a0:
//                     Q0 = delta_e - (column e of A0)/a0 on the vertex nodes, so A0 Q0 = 0;  B = row e of (I - P A0).
//   Q      Q = (I - P A) Q0. Then AQ = AQ0 - (AP)AQ0 = 0 and BQ = BQ0 - (BP)AQ0 = I. B does not change with A, so A may
//          be widened at will. (B section 7 finds this as lifting, with A = A0 + S B and Q = Q0 - P S.) Q is the only
//          one with (3) and (4), since [A; B] is regular.
//   Scale  A row of B and its column of Q may trade a factor. Where B comes from a flip or a product, the largest value
//          of each column of Q is made +1 (the first of equals), as in B(2.13), B(2.14).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subdivision/filters/diagram.h"

namespace isowave::subdivision {

struct Mask {
    std::string name;
    Lattice lattice = Lattice::Line;
    Diagram p;  // the column of P that belongs to the coarse node 0, over the fine nodes
};

struct Filters {
    Mask mask;
    int width = 0;  // of A: taps on the line, rings else
    Diagram a;
    std::vector<Node> details;  // the edge node that each of b, q stands for
    std::vector<Diagram> b, q;
};

// What was checked. `failure` names the first product that is wrong, and is empty when all are right.
struct Proof {
    std::size_t products = 0;
    std::string failure;
    explicit operator bool() const { return failure.empty(); }
};

// (1) to (4), exactly, for all shifts at which the diagrams overlap.
Proof prove(const Filters& filters);

// The least-norm A of this width and the B, Q that belong to it.
// Throws InputError, naming the mask, when
//   - no A of this width exists (and says which is the smallest that does), or none exists at all because P is not
//     injective: on the line its even and odd taps share a factor; on a torus its rank is short;
//   - no local B, Q0 is known (the mask neither interpolates, nor is a product, nor has a one-tap inverse);
//   - the width does not fit the mask (on the line both have an odd or both an even number of taps).
Filters construct(const Mask& mask, int width);

// The same for an A of the caller's own. Throws InputError when AP is not I.
Filters constructWith(const Mask& mask, const Diagram& a);

// The least-norm row alone, and the smallest width (up to `atMost`) at which there is one.
std::optional<Diagram> leastNormA(const Mask& mask, int width);
std::optional<int> smallestWidth(const Mask& mask, int atMost);

// The window of A: `width` taps around the middle of the mask on the line, a ball of `width` rings else.
std::vector<Node> windowOfA(const Mask& mask, int width);

// P keeps vertex nodes where they are.
bool interpolates(const Mask& mask);

// The left inverse of P that reads one vertex node only, if there is one in a ball of this width.
std::optional<Diagram> oneTapInverse(const Mask& mask, int width);

}  // namespace isowave::subdivision
