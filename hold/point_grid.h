// Points in cells of a lattice: one point a cell, and the nearest within a radius.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "volume/vdb.h"

namespace isowave {

// Positions in the order in which points are given; equal distances go to the first.
class PointGrid {
  public:
    // cell: the edge of a cell, about the radius that will be asked for. REQUIRES: cell > 0.
    PointGrid(const std::vector<openvdb::Vec3f>& points, double cell);

    static constexpr std::uint32_t kNone = ~0u;
    struct Nearest {
        std::uint32_t index = kNone;
        double distance = 0;
    };
    // REQUIRES: radius <= 2 cells.
    Nearest nearest(const openvdb::Vec3d& at, double radius) const;

  private:
    struct Range {
        std::uint32_t begin, end;
    };
    double cell_;
    std::vector<openvdb::Vec3f> points_;  // by cell
    std::vector<std::uint32_t> index_;
    std::unordered_map<openvdb::Coord, Range, std::hash<openvdb::Coord>> cells_;
};

// One point of each cell of edges `cell`: the first by `before`, a strict order of positions. In the order of positions.
template <class Points, class Before>
std::vector<std::uint32_t> oneOfEachCell(const Points& points, const openvdb::Vec3d& cell, const Before& before) {
    std::unordered_map<openvdb::Coord, std::uint32_t, std::hash<openvdb::Coord>> best;
    best.reserve(points.size() / 4);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const openvdb::Coord at = openvdb::Coord::floor(openvdb::Vec3d(points[i]) / cell);
        const auto [found, isNew] = best.emplace(at, i);
        if (!isNew && before(i, found->second)) found->second = i;
    }
    std::vector<std::uint32_t> kept;
    kept.reserve(best.size());
    for (const auto& [at, i] : best) kept.push_back(i);
    std::sort(kept.begin(), kept.end());
    return kept;
}

}  // namespace isowave
