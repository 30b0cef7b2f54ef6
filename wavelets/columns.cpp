#include "wavelets/columns.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

namespace isowave::wavelets {
namespace {

// A leaf with its place in the order: two comparisons of integers instead of three of coordinates behind a pointer.
struct Placed {
    std::int64_t uv;
    std::int32_t index;
    Column::Leaf* leaf;
    friend bool operator<(const Placed& a, const Placed& b) {
        return a.uv != b.uv ? a.uv < b.uv : a.index < b.index;
    }
};

}  // namespace

Columns::Columns(const openvdb::BoolTree& shape, int axis) {
    const auto other = otherAxes(axis);
    std::vector<Column::Leaf*> found;
    shape.getNodes(found);
    std::vector<Placed> placed(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        const openvdb::Coord& o = found[i]->origin();
        placed[i] = {std::int64_t(o[other[0]]) * (std::int64_t(1) << 32) + o[other[1]], o[axis] >> kLeafLog2,
                     found[i]};
    }
    tbb::parallel_sort(placed.begin(), placed.end());

    struct Extent {
        std::size_t at, count;
    };
    std::vector<Extent> extents;
    leaves_.reserve(placed.size() + placed.size() / 4);
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const Placed& p = placed[i];
        const std::int64_t missing = i == 0 ? 0 : std::int64_t(p.index) - placed[i - 1].index - 1;
        if (i == 0 || p.uv != placed[i - 1].uv || missing >= kGap) {
            const openvdb::Coord& o = p.leaf->origin();
            extents.push_back({leaves_.size(), 0});
            columns_.push_back({o[other[0]], o[other[1]], p.index, {}});
        } else {
            leaves_.insert(leaves_.end(), static_cast<std::size_t>(missing), nullptr);
        }
        leaves_.push_back(p.leaf);
        extents.back().count = leaves_.size() - extents.back().at;
    }
    for (std::size_t i = 0; i < columns_.size(); ++i)
        columns_[i].leaves = std::span(leaves_).subspan(extents[i].at, extents[i].count);
}

}  // namespace isowave::wavelets
