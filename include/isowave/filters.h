// The four filters of a subdivision's multiresolution: A, B, P and Q, exactly, with proof.
//
//   isowave::subdivision::FilterSet cubic = isowave::subdivision::filterSet("cubic-7");
//   cubic.a.taps[0].value      // "23/196"
//
//   f fine values, c coarse values, d details:    c = A f,   d = B f,   f = P c + Q d,
//   AP = I,   BP = 0,   AQ = 0,   BQ = I.
// P is the subdivision. A is the row of least norm among those on a window with AP = I, that is, the window's
// least-squares fit; B and Q follow. All of it is done in rational numbers.
// Bartels and Samavati, "Constructing biorthogonal multiresolutions from any subdivision with diagrams", sections 2, 7.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isowave/version.h"

namespace isowave::subdivision {

// Where values live. On the line x counts points and y is 0. On the triangular lattice (x, y) stands at
// (x + y/2, y sqrt3/2), with six neighbours; on the quad lattice at (x, y), with eight.
enum class Lattice { Line, Triangular, Quad };

// A value on a fine node. The fine node (2i, 2j) belongs to the coarse node (i, j).
struct FilterTap {
    int x = 0, y = 0;
    std::string value;  // "23/196", "-4": exact
    double number = 0;  // the double nearest to it
};

// A row of A or B, or a column of P or Q, for one coarse node; for the others it is moved by twice their distance.
struct Filter {
    int x = 0, y = 0;  // the node that it stands for: of A and P the coarse node 0, of B and Q an edge node
    std::vector<FilterTap> taps;  // those that are not 0, by x, then y
};

struct FilterSet {
    std::string subdivision;  // "cubic", "mask", ..
    Lattice lattice = Lattice::Line;
    int width = 0;  // of A: taps on the line, rings else
    Filter p, a;
    std::vector<Filter> b, q;  // one a detail: one on the line, three else
    // How many products of diagrams were checked, and the first that is wrong: empty, as it must be.
    std::size_t products = 0;
    std::string failure;
};

// By name: a mask's (chaikin, cubic, dlg, butterfly, loop, catmull-clark), bspline-D, loop-like:ALPHA,GAMMA, or a
// scheme's (cubic-7, dlg-refined, butterfly-3, loop-1). width: of A; without it the scheme's own, else the usual one
// (chaikin 4, cubic 7, dlg 9, butterfly 3, the others their smallest).
// Throws InputError: an unknown name (lists them), no A of this width (says which is the smallest that exists).
ISOWAVE_EXPORT FilterSet filterSet(std::string_view name, std::optional<int> width = {});

// For a mask of one's own: numbers as 3/4, -2 or 0.125, with spaces or commas between. On the line the taps in order,
// the middle one (or the left of the two middle ones) on the vertex node; else the values in spiral order (ring k
// starts at (0, k) and runs clockwise). Throws InputError: not a number (says which), only zeros, no left inverse.
ISOWAVE_EXPORT FilterSet maskFilterSet(std::string_view mask, Lattice lattice = Lattice::Line,
                                       std::optional<int> width = {});

}  // namespace isowave::subdivision
