// Points in cells of a lattice: the nearest within a radius.
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

}  // namespace isowave
