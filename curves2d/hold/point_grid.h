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
    // Of equally near ones the first. Squares of cells around the point's own are searched from the inside outwards.
    std::optional<Found> nearest(Point p, double radius) const {
        std::optional<Found> best;
        const GridCell centre = GridCell::of(p, cell_);
        const auto last = static_cast<std::int32_t>(std::ceil(radius / cell_));
        for (std::int32_t k = 0; k <= last; ++k) {
            if (best && best->distance < (k - 1) * cell_) break;
            eachCellOfSquare(centre, k, [&](std::uint32_t i) {
                const double d = length(points_[i] - p);
                if (d > radius) return;
                if (!best || d < best->distance || (d == best->distance && i < best->index))
                    best = Found{i, d};
            });
        }
        return best;
    }

  private:
    template <class F>
    void eachOf(GridCell at, const F& f) const {
        const auto cell = cells_.find(at.key());
        if (cell == cells_.end()) return;
        for (const std::uint32_t i : cell->second) f(i);
    }
    // The cells k columns or rows away from the centre.
    template <class F>
    void eachCellOfSquare(GridCell centre, std::int32_t k, const F& f) const {
        for (std::int32_t y = -k; y <= k; ++y)
            for (std::int32_t x = -k; x <= k; x += y == -k || y == k ? 1 : std::max(1, 2 * k))
                eachOf({centre.x + x, centre.y + y}, f);
    }

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
