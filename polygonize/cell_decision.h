// What the spline says where the signs of a cell's corners leave a choice (cell_table.h).
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "polygonize/cell_table.h"

namespace isowave {

// F in the middle of a cell, or of one of its faces, times a positive number: on an axis (1,23,23,1)/48 halfway between lattice
// points, (1,4,1)/6 on one. Sums of weights have 15 bits, control points 24: exact in double unless neighbours differ by
// more than 2^14 in size, so that both cells of a face see one sign.
// controlPoint(x, y, z): the one so far from the cell's lowest corner, -1 to 2 on each axis. face: as in a CellTable, -1 for none.
template <class ControlPoint>
double sumInMiddle(int face, const ControlPoint& controlPoint) {
    static constexpr double kHalfway[4] = {1, 23, 23, 1}, kOnPoint[4] = {1, 4, 1, 0};
    std::array<int, 3> from{-1, -1, -1}, taps{4, 4, 4};
    std::array<const double*, 3> weights{kHalfway, kHalfway, kHalfway};
    if (face >= 0) {
        const auto axis = static_cast<std::size_t>(face / 2);
        from[axis] += face % 2;
        taps[axis] = 3;  // two beyond a face are not asked for
        weights[axis] = kOnPoint;
    }
    double total = 0;
    for (int x = 0; x < taps[0]; ++x)
        for (int y = 0; y < taps[1]; ++y)
            for (int z = 0; z < taps[2]; ++z)
                total += weights[0][x] * weights[1][y] * weights[2][z] *
                         controlPoint(from[0] + x, from[1] + y, from[2] + z);
    return total;
}

template <class ControlPoint>
CellDecision decide(unsigned pattern, const ControlPoint& controlPoint) {
    CellDecision decision;
    for (unsigned faces = cellTable().ambiguousFaces(pattern); faces != 0; faces &= faces - 1) {
        const int face = std::countr_zero(faces);
        if (sumInMiddle(face, controlPoint) < 0) decision.joined |= static_cast<std::uint8_t>(1 << face);
    }
    if (cellTable().needsMiddle(pattern, decision.joined))
        decision.middleInside = sumInMiddle(-1, controlPoint) < 0;
    return decision;
}

}  // namespace isowave
