// The edges of a triangle soup, and which triangles use them which way round: what the passes of repairMesh stand on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "isowave/mesh.h"
#include "isowave/progress.h"

namespace isowave::repair {

using Index = std::uint32_t;

// Asks whether to stop at one of this many steps of a loop; asking at each would cost more than the step.
inline constexpr std::size_t kStepsBetweenChecks = std::size_t(1) << 16;

inline void checkNowAndThen(const Progress& progress, std::size_t step) {
    if (step % kStepsBetweenChecks == 0) progress.check();
}

// std::sort, the slow part of most passes, left by Cancelled within a moment of the stop being asked for.
template <class T, class Less>
void sortUnlessStopped(std::vector<T>& values, const Progress& progress, const Less& less) {
    std::size_t compared = 0;
    std::sort(values.begin(), values.end(), [&](const T& a, const T& b) {
        checkNowAndThen(progress, ++compared);
        return less(a, b);
    });
}

// One triangle's use of an edge, from `low` to `high` or back.
struct EdgeUse {
    Index low, high, triangle;
    bool forward;

    bool sameEdge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

// All uses, those of one edge side by side, in ascending order of edges.
std::vector<EdgeUse> edgeUses(const std::vector<Triangle>& triangles, const Progress& progress);

// Calls visit(first, count) for the uses of each edge.
template <class Visit>
void forEachEdge(const std::vector<EdgeUse>& uses, const Visit& visit) {
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        for (end = begin + 1; end < uses.size() && uses[end].sameEdge(uses[begin]); ++end) continue;
        visit(&uses[begin], end - begin);
    }
}

// Uses one way less uses the other way.
int balance(const EdgeUse* use, std::size_t count);

// Every edge is used equally often both ways; an edge of odd use, once more one way.
bool isBalanced(const std::vector<EdgeUse>& uses);

}  // namespace isowave::repair
