#include "volume/repair/edges.h"

#include <cmath>

namespace isowave::repair {

std::vector<EdgeUse> edgeUses(const std::vector<Triangle>& triangles, const Progress& progress) {
    std::vector<EdgeUse> uses;
    uses.reserve(3 * triangles.size());
    for (Index t = 0; t < triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
            const Index a = triangles[t][i], b = triangles[t][(i + 1) % 3];
            uses.push_back({std::min(a, b), std::max(a, b), t, a < b});
        }
    }
    sortUnlessStopped(uses, progress, [](const EdgeUse& a, const EdgeUse& b) {
        if (a.low != b.low) return a.low < b.low;
        return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    return uses;
}

int balance(const EdgeUse* use, std::size_t count) {
    int sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += use[i].forward ? 1 : -1;
    return sum;
}

bool isBalanced(const std::vector<EdgeUse>& uses) {
    bool balanced = true;
    forEachEdge(uses, [&](const EdgeUse* use, std::size_t count) {
        balanced = balanced && std::abs(balance(use, count)) == static_cast<int>(count % 2);
    });
    return balanced;
}

}  // namespace isowave::repair
