#include "curves2d/hold/regions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace isowave::curves2d {

Regions::Regions(const Curves& curves, double pixel, double spacing) : spacing_(spacing) {
    for (const CurveRing& ring : curves.rings) {
        inside_.push_back(!ring.hole);
        area_.push_back(pixel * pixel * std::abs(signedArea(ring.points)));
    }
    const std::vector<double> whole = area_;
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        const CurveRing& ring = curves.rings[r];
        if (ring.parent >= 0) area_[static_cast<std::size_t>(ring.parent)] -= whole[r];
        for (std::size_t k = 0; k < ring.points.size(); ++k) {
            const Point a = pixel * ring.points[k], b = pixel * ring.points[(k + 1) % ring.points.size()];
            const double low = std::min(a.y, b.y), high = std::max(a.y, b.y);
            // Rows with low <= y < high, so that a point on a row counts for one of its two pieces.
            for (auto j = static_cast<std::int32_t>(std::ceil(low / spacing)); spacing * j < high; ++j)
                crossings_.push_back({a.x + (spacing * j - a.y) * (b.x - a.x) / (b.y - a.y), j,
                                      static_cast<std::int32_t>(r), kWorld});
        }
    }
    std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
        return a.row != b.row ? a.row < b.row : a.x != b.x ? a.x < b.x : a.ring < b.ring;
    });
    // Rings that a walk along a row is in, the innermost last (contour.cpp: nest).
    std::vector<std::int32_t> open;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        if (i > 0 && crossings_[i].row != crossings_[i - 1].row) open.clear();
        if (!open.empty() && open.back() == crossings_[i].ring)
            open.pop_back();
        else
            open.push_back(crossings_[i].ring);
        crossings_[i].after = open.empty() ? kWorld : open.back();
    }
    begin_.assign(inside_.size() + 1, 0);
    for (const Crossing& c : crossings_)
        if (c.after != kWorld) ++begin_[static_cast<std::size_t>(c.after) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    stretches_.resize(begin_.back());
    std::vector<std::uint32_t> next = begin_;
    for (std::uint32_t i = 0; i < crossings_.size(); ++i)
        if (crossings_[i].after != kWorld)
            stretches_[next[static_cast<std::size_t>(crossings_[i].after)]++] = i;
}

std::int32_t Regions::at(std::int32_t i, std::int32_t j) const {
    const double x = spacing_ * i;
    const auto behind = std::partition_point(crossings_.begin(), crossings_.end(), [&](const Crossing& c) {
        return c.row != j ? c.row < j : c.x <= x;
    });
    if (behind == crossings_.begin() || std::prev(behind)->row != j) return kWorld;
    return std::prev(behind)->after;
}

std::vector<Regions::Cell> Regions::points(std::int32_t region) const {
    std::vector<Cell> points;
    const auto r = static_cast<std::size_t>(region);
    for (std::uint32_t k = begin_[r]; k < begin_[r + 1]; ++k) {
        const Crossing &from = crossings_[stretches_[k]], &to = crossings_[stretches_[k] + 1];
        for (auto i = static_cast<std::int32_t>(std::ceil(from.x / spacing_)); spacing_ * i < to.x; ++i)
            points.push_back({i, from.row});
    }
    return points;
}

Overlaps::Overlaps(const Regions& over, const Regions& under) {
    std::map<std::pair<std::int32_t, std::int32_t>, double> lengths;
    const auto &a = over.crossings_, &b = under.crossings_;
    std::size_t i = 0, j = 0;
    while (i < a.size() || j < b.size()) {
        const std::int32_t row = i == a.size()   ? b[j].row
                                 : j == b.size() ? a[i].row
                                                 : std::min(a[i].row, b[j].row);
        std::int32_t regionA = Regions::kWorld, regionB = Regions::kWorld;
        double x = -INFINITY;
        for (;;) {
            const bool hasA = i < a.size() && a[i].row == row, hasB = j < b.size() && b[j].row == row;
            if (!hasA && !hasB) break;
            const bool takeA = hasA && (!hasB || a[i].x <= b[j].x);
            const double next = takeA ? a[i].x : b[j].x;
            if (next > x && over.inside(regionA) == under.inside(regionB) && x > -INFINITY)
                lengths[{regionA, regionB}] += next - x;
            x = next;
            if (takeA)
                regionA = a[i++].after;
            else
                regionB = b[j++].after;
        }
    }
    for (const auto& [pair, length] : lengths)
        overlaps_.push_back({pair.first, pair.second, length * over.spacing_});
}

std::vector<std::int32_t> excessRegions(const Regions& curves, const Regions& before) {
    const Overlaps overlaps(curves, before);
    std::vector<std::int32_t> order;
    for (std::int32_t r = 0; r < curves.count(); ++r) order.push_back(r);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int32_t a, std::int32_t b) { return curves.area(a) > curves.area(b); });
    std::set<std::int32_t> owned{Regions::kWorld};  // by the world
    std::vector<std::int32_t> excess;
    for (const std::int32_t region : order) {
        const Overlaps::Overlap* best = nullptr;
        auto at = std::lower_bound(overlaps.all().begin(), overlaps.all().end(), region,
                                   [](const Overlaps::Overlap& o, std::int32_t r) { return o.over < r; });
        for (; at != overlaps.all().end() && at->over == region; ++at)
            if (!owned.count(at->under) && (!best || at->area > best->area)) best = &*at;
        if (best)
            owned.insert(best->under);
        else
            excess.push_back(region);
    }
    std::sort(excess.begin(), excess.end());
    return excess;
}

Curves withoutRings(const Curves& curves, const std::vector<std::int32_t>& rings) {
    if (rings.empty()) return curves;
    const std::set<std::int32_t> gone(rings.begin(), rings.end());
    std::vector<std::int32_t> newIndex(curves.rings.size(), -1);
    Curves out;
    out.frame = curves.frame;
    for (std::size_t r = 0; r < curves.rings.size(); ++r) {
        bool keep = true;
        for (auto at = static_cast<std::int32_t>(r); at >= 0 && keep;
             at = curves.rings[static_cast<std::size_t>(at)].parent)
            keep = !gone.count(at);
        if (!keep) continue;
        newIndex[r] = static_cast<std::int32_t>(out.rings.size());
        out.rings.push_back(curves.rings[r]);
    }
    for (CurveRing& ring : out.rings)
        if (ring.parent >= 0) ring.parent = newIndex[static_cast<std::size_t>(ring.parent)];
    return out;
}

}  // namespace isowave::curves2d
