// Points of the plane in square cells: the nearest one within a radius, those in a box.
#pragma once

#include <tsl/robin_map.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "curves2d/geometry.h"
#include "curves2d/hold/mixed.h"

namespace isowave::curves2d {

// The cell of a point: column and row of a grid of squares.
struct GridCell {
    std::int32_t x, y;
    static GridCell of(Point p, double size) {
        return {static_cast<std::int32_t>(std::floor(p.x / size)),
                static_cast<std::int32_t>(std::floor(p.y / size))};
    }
    std::uint64_t key() const {
        return mixed(static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32 |
                     static_cast<std::uint32_t>(x));
    }
    friend bool operator==(const GridCell&, const GridCell&) = default;
};

class PointGrid {
  public:
    PointGrid(const std::vector<Point>& points, double cell) : points_(points), cell_(cell) {
        for (std::uint32_t i = 0; i < points.size(); ++i)
            cells_[GridCell::of(points[i], cell).key()].push_back(i);
    }

    struct Found {
        std::uint32_t index;
        double distance;
    };
    // Of equally near ones the first. REQUIRES: radius <= cell.
    std::optional<Found> nearest(Point p, double radius) const {
        std::optional<Found> best;
        eachIn({p - Point{radius, radius}, p + Point{radius, radius}}, [&](std::uint32_t i) {
            const double d = length(points_[i] - p);
            if (d > radius) return;
            if (!best || d < best->distance || (d == best->distance && i < best->index)) best = Found{i, d};
        });
        return best;
    }
    // Calls f(index) for every point of the cells that the box meets.
    template <class F>
    void eachIn(const Box& box, const F& f) const {
        const GridCell low = GridCell::of(box.low, cell_), high = GridCell::of(box.high, cell_);
        for (std::int32_t y = low.y; y <= high.y; ++y)
            for (std::int32_t x = low.x; x <= high.x; ++x) {
                const auto cell = cells_.find(GridCell{x, y}.key());
                if (cell == cells_.end()) continue;
                for (const std::uint32_t i : cell->second) f(i);
            }
    }

  private:
    std::vector<Point> points_;
    double cell_;
    tsl::robin_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

// The indices of one point a cell, the one with the smallest `order` (of equal ones the first), ascending.
inline std::vector<std::uint32_t> oneOfEachCell(const std::vector<Point>& points,
                                                const std::vector<double>& order, double cell) {
    tsl::robin_map<std::uint64_t, std::uint32_t> best;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const auto [at, isNew] = best.insert({GridCell::of(points[i], cell).key(), i});
        if (!isNew && order[i] < order[at->second]) at.value() = i;
    }
    std::vector<std::uint32_t> chosen;
    chosen.reserve(best.size());
    for (const auto& [key, i] : best) chosen.push_back(i);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

}  // namespace isowave::curves2d
