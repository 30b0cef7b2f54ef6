#include "hold/point_grid.h"

#include <algorithm>
#include <cmath>

namespace isowave {

using openvdb::Coord;
using openvdb::Vec3d;

PointGrid::PointGrid(const std::vector<openvdb::Vec3f>& points, double cell) : cell_(cell) {
    struct Placed {
        Coord cell;
        std::uint32_t index;
    };
    std::vector<Placed> placed(points.size());
    for (std::uint32_t i = 0; i < points.size(); ++i) placed[i] = {Coord::floor(Vec3d(points[i]) / cell), i};
    std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
        return a.cell != b.cell ? a.cell < b.cell : a.index < b.index;
    });
    points_.reserve(points.size());
    index_.reserve(points.size());
    for (const Placed& p : placed) {
        const auto here = static_cast<std::uint32_t>(points_.size());
        cells_.emplace(p.cell, Range{here, here}).first->second.end = here + 1;
        points_.push_back(points[p.index]);
        index_.push_back(p.index);
    }
}

PointGrid::Nearest PointGrid::nearest(const Vec3d& at, double radius) const {
    Nearest best;
    double bound = radius * radius;
    const Coord low = Coord::floor((at - Vec3d(radius)) / cell_),
                high = Coord::floor((at + Vec3d(radius)) / cell_);
    for (int x = low[0]; x <= high[0]; ++x)
        for (int y = low[1]; y <= high[1]; ++y)
            for (int z = low[2]; z <= high[2]; ++z) {
                const auto found = cells_.find({x, y, z});
                if (found == cells_.end()) continue;
                for (std::uint32_t i = found->second.begin; i < found->second.end; ++i) {
                    const double squared = (Vec3d(points_[i]) - at).lengthSqr();
                    if (squared > bound || (squared == bound && index_[i] >= best.index)) continue;
                    bound = squared;
                    best.index = index_[i];
                }
            }
    best.distance = std::sqrt(bound);
    return best;
}

}  // namespace isowave
