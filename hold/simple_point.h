// Simple points: those that can change sides without changing the topology of a set of lattice points X and of its
// complement Y, where X is joined along axes (6 neighbours) and Y also across edges and corners (26).
//
// G. Bertrand, G. Malandain: "A new characterization of three-dimensional simple points", Pattern Recognition Letters
// 15, 1994: a point is simple exactly where both numbers below are 1.
#pragma once

#include <array>
#include <cstdint>

namespace isowave {

// A point's 27 neighbours and itself: bit (dx + 1) * 9 + (dy + 1) * 3 + dz + 1.
using Neighbours = std::uint32_t;
constexpr int kCentreBit = 13;

namespace simple_point {

constexpr int differing(int i, int j) {
    return (i / 9 != j / 9) + (i / 3 % 3 != j / 3 % 3) + (i % 3 != j % 3);
}
constexpr bool isNear(int i, int j) {
    const auto within = [](int a, int b) { return a - b <= 1 && b - a <= 1; };
    return i != j && within(i / 9, j / 9) && within(i / 3 % 3, j / 3 % 3) && within(i % 3, j % 3);
}

struct Tables {
    std::array<Neighbours, 27> six{}, all{};
    Neighbours eighteen = 0;  // of the centre
    constexpr Tables() {
        for (int i = 0; i < 27; ++i)
            for (int j = 0; j < 27; ++j)
                if (isNear(i, j)) {
                    all[i] |= 1u << j;
                    if (differing(i, j) == 1) six[i] |= 1u << j;
                    if (i == kCentreBit && differing(i, j) <= 2) eighteen |= 1u << j;
                }
    }
};
inline constexpr Tables kTables;

// How many components of `set` have a point in `seeds`.
inline int components(Neighbours set, Neighbours seeds, const std::array<Neighbours, 27>& near) {
    int count = 0;
    for (Neighbours left = set & seeds; left != 0; ++count) {
        Neighbours reached = left & (~left + 1), front = reached;
        while (front != 0) {
            const int i = __builtin_ctz(front);
            front &= front - 1;
            const Neighbours next = near[i] & set & ~reached;
            reached |= next;
            front |= next;
        }
        left &= ~reached;
    }
    return count;
}

}  // namespace simple_point

// x: which of the neighbours are in X. How many pieces of X the point touches, and of Y.
inline int touchedOfX(Neighbours x) {
    using namespace simple_point;
    return components(x & kTables.eighteen, kTables.six[kCentreBit], kTables.six);
}
inline int touchedOfY(Neighbours x) {
    using namespace simple_point;
    constexpr Neighbours kAll = kTables.all[kCentreBit];
    return components(~x & kAll, kAll, kTables.all);
}
inline bool isSimple(Neighbours x) { return touchedOfX(x) == 1 && touchedOfY(x) == 1; }

}  // namespace isowave
