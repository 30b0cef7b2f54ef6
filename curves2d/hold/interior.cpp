#include "curves2d/hold/interior.h"

#include <algorithm>
#include <cmath>

namespace isowave::curves2d {
namespace {

std::vector<Segment> piecesOf(const Curves& curves) {
    std::vector<Segment> pieces;
    pieces.reserve(curves.pointCount());
    for (const CurveRing& ring : curves.rings)
        for (std::size_t i = 0; i < ring.points.size(); ++i)
            pieces.push_back({ring.points[i], ring.points[(i + 1) % ring.points.size()]});
    return pieces;
}

// Where the piece crosses the vertical line through x, if it does.
std::optional<double> heightAt(const Segment& s, double x) {
    if ((s.a.x <= x) == (s.b.x <= x)) return std::nullopt;
    return s.a.y + (x - s.a.x) * (s.b.y - s.a.y) / (s.b.x - s.a.x);
}

}  // namespace

Interior::Interior(const Curves& curves)
    : segments_(piecesOf(curves)), tree_(segments_), area_(curves.rings.size(), 0) {
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        const CurveRing& ring = curves.rings[r];
        outer_.push_back(ring.hole ? ring.parent : static_cast<std::int32_t>(r));
        area_[static_cast<std::size_t>(outer_.back())] += signedArea(ring.points);
        ringOfSegment_.insert(ringOfSegment_.end(), ring.points.size(), static_cast<std::int32_t>(r));
    }
    for (std::size_t i = 0; i < segments_.size(); ++i) addCrossings(i);
    for (const double area : area_) largest_ = std::max(largest_, area);
    std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
        return a.at.y != b.at.y ? a.at.y < b.at.y : a.at.x < b.at.x;
    });
}

// With rows low <= y < high, so that a point on a row counts for one of its two segments.
void Interior::addCrossings(std::size_t segment) {
    const auto [a, b] = segments_[segment];
    const double high = std::max(a.y, b.y);
    for (double y = std::ceil(std::min(a.y, b.y)); y < high; ++y)
        crossings_.push_back({{a.x + (y - a.y) * (b.x - a.x) / (b.y - a.y), y}, ringOfSegment_[segment]});
}

// From far left along the lattice row below the point, then upwards. The last curve that is crossed bounds the part.
std::optional<std::int32_t> Interior::part(Point p) const {
    const double row = std::floor(p.y);
    const auto rowBegin = std::lower_bound(crossings_.begin(), crossings_.end(), row,
                                           [](const Crossing& c, double y) { return c.at.y < y; });
    const auto behind = std::partition_point(
        rowBegin, crossings_.end(), [&](const Crossing& c) { return c.at.y == row && c.at.x <= p.x; });
    bool in = (behind - rowBegin) % 2 == 1;
    std::int32_t ring = in ? std::prev(behind)->ring : -1;
    double highest = -INFINITY;
    Box way;
    way.take(Point{p.x, row});
    way.take(p);
    tree_.eachMeeting(way, [&](std::size_t i) {
        const std::optional<double> height = heightAt(segments_[i], p.x);
        if (!height || *height <= row || *height > p.y) return true;
        in = !in;
        if (*height > highest) {
            highest = *height;
            ring = ringOfSegment_[i];
        }
        return true;
    });
    return in ? std::optional(partOf(ring)) : std::nullopt;
}

}  // namespace isowave::curves2d
