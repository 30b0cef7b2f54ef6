// F at the known lattice points, and what follows from its signs.
//
//   F(i) = sum over the 27 neighbours of w_x w_y w_z c,  w = 1/6, 4/6, 1/6
//
// Unknown points are worth K with a sign: that of the known point before them in their row, and outside before the first and
// after the last point of a row. The sums are of doubles in one order, so their bits depend neither on threads nor on the machine.
#pragma once

#include <cstdint>
#include <vector>

#include "compress/coder/lattice.h"

namespace isowave::compress {

using Flags = std::vector<std::uint8_t>;  // one for each known point

// c: of the known points. inside: the signs that gaps take from the point before; null: those of c itself.
std::vector<float> latticeValues(const Lattice& lattice, const std::vector<float>& c, float K,
                                 const Flags* inside);

// The corners of nodes that the surface passes: known points one of whose 26 neighbours has the other sign.
Flags nearSurface(const Lattice& lattice, const Flags& inside);

// How far F moves there, in K. Both have the signs of `inside`.
struct Change {
    double largest = 0, rms = 0;
};
Change changeNear(const Lattice& lattice, const std::vector<float>& before, const std::vector<float>& after,
                  float K, const Flags& inside);

// The median length of F's gradient there, by a lattice step; of differences with the earlier neighbour on each axis.
double medianSlope(const Lattice& lattice, const std::vector<float>& c, float K, const Flags& inside);

}  // namespace isowave::compress
