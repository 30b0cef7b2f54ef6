#include "curves2d/hold/outline.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace isowave::curves2d {

Outline::Outline(const RowField<float>& field, const Curves& curves) : interior_(curves) {
    double sum = 0;
    points_.reserve(curves.pointCount());
    for (std::size_t r = 0; r < curves.rings.size(); ++r)
        for (const Point& p : curves.rings[r].points) {
            const Point gradient = sample(field, p).gradient;
            const double slope = std::max(length(gradient), 1e-30);
            sum += slope;
            points_.push_back({p, (1 / slope) * gradient, static_cast<std::int32_t>(r)});
        }
    if (!points_.empty()) slope_ = sum / static_cast<double>(points_.size());
}

// Along a line the curves alternately go in and out.
std::vector<Outline::Chord> Outline::chords(int axis) const {
    const auto line = [&](std::uint32_t i) { return points_[i].at[1 - axis]; };
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < points_.size(); ++i)
        if (line(i) == std::floor(line(i))) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return line(a) != line(b) ? line(a) < line(b) : points_[a].at[axis] < points_[b].at[axis];
    });
    assert(order.size() % 2 == 0);
    std::vector<Chord> chords;
    for (std::size_t i = 0; i + 1 < order.size(); i += 2) chords.push_back({order[i], order[i + 1]});
    return chords;
}

}  // namespace isowave::curves2d
