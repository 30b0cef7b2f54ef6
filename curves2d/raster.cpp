#include "curves2d/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "isowave/error.h"

namespace isowave::curves2d {
namespace {

__extension__ using Wide = __int128;

constexpr int kSubBits = 20;
constexpr std::int64_t kSub = std::int64_t{1} << kSubBits;
constexpr double kMostSteps = 1 << 28;

struct Exact {
    std::int64_t x, y;  // in 2^-20 of a lattice step
    friend auto operator<=>(const Exact&, const Exact&) = default;
};

Exact snap(Point world, const Frame& frame) {
    const Point p = frame.toLattice(world);
    if (!(std::abs(p.x) <= kMostSteps && std::abs(p.y) <= kMostSteps))
        throw InputError("polygons", fmt::format("the point ({}, {}) lies more than 2^28 pixels away; take "
                                                 "fewer pixels or leave it out",
                                                 world.x, world.y));
    return {std::llround(p.x * kSub), std::llround(p.y * kSub)};
}

// The smallest integer >= a / b. REQUIRES: b > 0.
std::int64_t ceilDivide(Wide a, Wide b) {
    const Wide q = a / b;
    return static_cast<std::int64_t>(q + (a > 0 && q * b != a));
}

// A boundary crosses lattice row `row` between position - 1 and position (or exactly at position).
struct Crossing {
    std::int32_t row, position;
    friend auto operator<=>(const Crossing&, const Crossing&) = default;
};

// Rows Y with a.y <= Y < b.y (upwards): the crossing lies at a.x + (Y - a.y)(b.x - a.x)/(b.y - a.y), and the
// first lattice point that is not left of it at the ceiling of that.
void crossingsOf(Exact a, Exact b, std::vector<Crossing>& out) {
    if (a.y > b.y) std::swap(a, b);
    const std::int64_t firstRow = ceilDivide(a.y, kSub), endRow = ceilDivide(b.y, kSub);
    const Wide dx = b.x - a.x, dy = b.y - a.y;
    for (std::int64_t row = firstRow; row < endRow; ++row) {
        const Wide numerator = Wide(a.x) * dy + Wide(row * kSub - a.y) * dx;
        out.push_back(
            {static_cast<std::int32_t>(row), static_cast<std::int32_t>(ceilDivide(numerator, dy * kSub))});
    }
}

}  // namespace

Frame frameAround(const std::vector<Polygon>& polygons, std::int32_t pixels) {
    Point low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    for (const Polygon& polygon : polygons)
        for (const Ring& ring : polygon.rings)
            for (const Point& p : ring) {
                low = {std::min(low.x, p.x), std::min(low.y, p.y)};
                high = {std::max(high.x, p.x), std::max(high.y, p.y)};
            }
    const double extent = std::max(high.x - low.x, high.y - low.y);
    if (!(extent > 0)) throw InputError("polygons", "no ring has an extent; there is nothing to draw");
    const double h = extent / pixels;
    return {{low.x + h / 2, low.y + h / 2}, {h, h}};
}

Region rasterise(const std::vector<Polygon>& polygons, const Frame& frame, const Progress& progress) {
    std::vector<std::pair<std::int32_t, Span>> inside;
    std::vector<Crossing> crossings;
    std::vector<Exact> points;
    for (std::size_t n = 0; n < polygons.size(); ++n) {
        if (n % 64 == 0)
            progress("rasterising", static_cast<double>(n) / static_cast<double>(polygons.size()));
        crossings.clear();
        for (const Ring& ring : polygons[n].rings) {
            points.clear();
            for (const Point& p : ring) points.push_back(snap(p, frame));
            for (std::size_t i = 0; i < points.size(); ++i)
                crossingsOf(points[i], points[(i + 1) % points.size()], crossings);
        }
        std::sort(crossings.begin(), crossings.end());
        // Every ring crosses a row an even number of times.
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
            if (crossings[i].position < crossings[i + 1].position)
                inside.push_back({crossings[i].row, {crossings[i].position, crossings[i + 1].position - 1}});
    }
    Region region;
    if (inside.empty()) return region;
    const auto byRow = [](const auto& a, const auto& b) { return a.first < b.first; };
    const auto [low, high] = std::minmax_element(inside.begin(), inside.end(), byRow);
    region.firstRow = low->first;
    region.rows.resize(static_cast<std::size_t>(high->first - low->first + 1));
    for (const auto& [row, span] : inside)
        region.rows[static_cast<std::size_t>(row - region.firstRow)].push_back(span);
    for (Spans& row : region.rows) normalise(row);
    return region;
}

std::vector<Segment> boundary(const std::vector<Polygon>& polygons, const Frame& frame) {
    struct Edge {
        Exact low, high;
        Segment segment;
    };
    std::vector<Edge> edges;
    for (const Polygon& polygon : polygons)
        for (const Ring& ring : polygon.rings)
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const Point a = ring[i], b = ring[(i + 1) % ring.size()];
                const Exact ea = snap(a, frame), eb = snap(b, frame);
                if (ea != eb)
                    edges.push_back(
                        {std::min(ea, eb), std::max(ea, eb), {frame.toLattice(a), frame.toLattice(b)}});
            }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return std::tie(a.low, a.high) < std::tie(b.low, b.high); });
    std::vector<Segment> out;
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i + 1;
        while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high)
            ++end;
        if ((end - i) % 2 == 1) out.push_back(edges[i].segment);
        i = end;
    }
    return out;
}

}  // namespace isowave::curves2d
