#include "simplify/boxes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace isowave {

TriangleBoxes::TriangleBoxes(const TriangleMesh& mesh) : tree_(mesh.triangles.size(), kInLeaf) {
    assert(!mesh.triangles.empty());
    const std::size_t count = mesh.triangles.size();
    std::vector<std::array<float, 3>> centres(count);  // three times as large, which does not matter
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            for (std::size_t a = 0; a < 3; ++a) {
                double sum = 0;
                for (const std::uint32_t v : mesh.triangles[i]) sum += mesh.points[v][a];
                centres[i][a] = static_cast<float>(sum);
            }
    });
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), 0u);
    boxes_.resize(tree_.boxCount());
    tree_.build(
        tree_.root(), [&](const Range& range) { divide(centres, range); },
        [&](const Range& range) { bound(mesh, range); });
}

void TriangleBoxes::divide(const std::vector<std::array<float, 3>>& centres, const Range& range) {
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t i = range.begin; i < range.end; ++i)
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], centres[order_[i]][a]);
            high[a] = std::max(high[a], centres[order_[i]][a]);
        }
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
        if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    const auto first = order_.begin();
    // Ties by number: which half a triangle goes to must not depend on the library's nth_element.
    std::nth_element(first + std::ptrdiff_t(range.begin), first + std::ptrdiff_t(range.middle()),
                     first + std::ptrdiff_t(range.end), [&](std::uint32_t a, std::uint32_t b) {
                         return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis]
                                                                     : a < b;
                     });
}

void TriangleBoxes::bound(const TriangleMesh& mesh, const Range& range) {
    if (tree_.isLeaf(range)) {
        boxes_[range.box] = boxOf(mesh, range);
        return;
    }
    const Box &a = boxes_[range.left().box], &b = boxes_[range.right().box];
    for (std::size_t k = 0; k < 3; ++k) {
        boxes_[range.box].low[k] = std::min(a.low[k], b.low[k]);
        boxes_[range.box].high[k] = std::max(a.high[k], b.high[k]);
    }
}

TriangleBoxes::Box TriangleBoxes::boxOf(const TriangleMesh& mesh, const Range& range) const {
    constexpr float kAll = std::numeric_limits<float>::infinity();
    const auto below = [](double x) {
        const auto f = static_cast<float>(x);
        return f > x ? std::nextafter(f, -kAll) : f;
    };
    const auto above = [](double x) {
        const auto f = static_cast<float>(x);
        return f < x ? std::nextafter(f, kAll) : f;
    };
    Box box;
    box.low.fill(kAll);
    box.high.fill(-kAll);
    for (std::size_t i = range.begin; i < range.end; ++i)
        for (const std::uint32_t v : mesh.triangles[order_[i]])
            for (std::size_t a = 0; a < 3; ++a) {
                box.low[a] = std::min(box.low[a], below(mesh.points[v][a]));
                box.high[a] = std::max(box.high[a], above(mesh.points[v][a]));
            }
    return box;
}

}  // namespace isowave
