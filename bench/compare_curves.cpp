// compare_curves POLYGONS [PIXELS [FOLDER]]: levels of `isowave curves` beside the polyline simplifications
// that people use, at equal numbers of points, as a markdown table; with FOLDER also pictures.
//
//   Douglas-Peucker  vertices ranked by the distance at which the recursion would take them in
//   Visvalingam      vertices ranked by the area of the triangle that goes when they go (Visvalingam, Whyatt
//   1993) CGAL             Polyline_simplification_2: Dyken et al., keeps the topology. GPL: this program
//   only
// A ring of fewer than three points is dropped, as the usual tools do.
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polyline_simplification_2/Squared_distance_cost.h>
#include <CGAL/Polyline_simplification_2/Stop_below_count_threshold.h>
#include <CGAL/Polyline_simplification_2/simplify.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <queue>
#include <set>

#include "curves2d/draw.h"
#include "curves2d/ladder.h"
#include "curves2d/polygon_input.h"
#include "curves2d/raster.h"

namespace {

using namespace isowave::curves2d;
using Rank = std::vector<std::vector<double>>;  // by ring and point: larger = kept longer

// ---- Douglas-Peucker
// ----------------------------------------------------------------------------------------

// Between two kept points, the farthest from their chord comes next; none comes before the one it hangs on.
void rankBetween(const Ring& ring, std::size_t first, std::size_t last, double limit,
                 std::vector<double>& rank) {
    if (last - first < 2) return;
    const Segment chord{ring[first], ring[last % ring.size()]};
    std::size_t best = first + 1;
    double distance = -1;
    for (std::size_t i = first + 1; i < last; ++i) {
        const double d = squaredDistance(ring[i], chord);
        if (d > distance) {
            distance = d;
            best = i;
        }
    }
    rank[best] = std::min(limit, distance);
    rankBetween(ring, first, best, rank[best], rank);
    rankBetween(ring, best, last, rank[best], rank);
}

Rank douglasPeucker(const std::vector<Ring>& rings) {
    Rank ranks;
    for (const Ring& ring : rings) {
        std::vector<double>& rank = ranks.emplace_back(ring.size(), 0.0);
        std::size_t far = 0;
        for (std::size_t i = 0; i < ring.size(); ++i)
            if (length(ring[i] - ring[0]) > length(ring[far] - ring[0])) far = i;
        rank[0] = rank[far] = dot(ring[far] - ring[0], ring[far] - ring[0]);
        rankBetween(ring, 0, far, rank[0], rank);
        rankBetween(ring, far, ring.size(), rank[0], rank);
    }
    return ranks;
}

// ---- Visvalingam
// --------------------------------------------------------------------------------------------

std::vector<double> visvalingamOf(const Ring& ring) {
    const std::size_t n = ring.size();
    std::vector<std::size_t> before(n), after(n);
    std::vector<double> rank(n, 0.0), area(n);
    const auto triangle = [&](std::size_t i) {
        return 0.5 * std::abs(cross(ring[i] - ring[before[i]], ring[after[i]] - ring[before[i]]));
    };
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::size_t i = 0; i < n; ++i) before[i] = (i + n - 1) % n, after[i] = (i + 1) % n;
    for (std::size_t i = 0; i < n; ++i) queue.push({area[i] = triangle(i), i});
    std::vector<char> gone(n, 0);
    double reached = 0;
    std::size_t left = n;
    while (!queue.empty()) {
        const auto [size, i] = queue.top();
        queue.pop();
        if (gone[i] || size != area[i]) continue;
        reached = std::max(reached, size);
        rank[i] = reached;
        if (left <= 3) continue;  // the last three go together
        gone[i] = 1;
        --left;
        after[before[i]] = after[i];
        before[after[i]] = before[i];
        for (const std::size_t j : {before[i], after[i]}) queue.push({area[j] = triangle(j), j});
    }
    return rank;
}

Rank visvalingam(const std::vector<Ring>& rings) {
    Rank ranks;
    for (const Ring& ring : rings) ranks.push_back(visvalingamOf(ring));
    return ranks;
}

// The `count` points of the highest ranks.
std::vector<Ring> best(const std::vector<Ring>& rings, const Rank& ranks, std::size_t count) {
    std::vector<double> all;
    for (const auto& rank : ranks) all.insert(all.end(), rank.begin(), rank.end());
    count = std::min(count, all.size());
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count) - 1, all.end(),
                     std::greater<>());
    const double least = all[count - 1];
    std::vector<Ring> out;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        Ring ring;
        for (std::size_t i = 0; i < rings[r].size(); ++i)
            if (ranks[r][i] >= least) ring.push_back(rings[r][i]);
        if (ring.size() >= 3) out.push_back(std::move(ring));
    }
    return out;
}

// ---- CGAL
// ---------------------------------------------------------------------------------------------------

namespace PS = CGAL::Polyline_simplification_2;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Constrained_triangulation_plus_2<CGAL::Constrained_Delaunay_triangulation_2<
    Kernel,
    CGAL::Triangulation_data_structure_2<PS::Vertex_base_2<Kernel>,
                                         CGAL::Constrained_triangulation_face_base_2<Kernel>>,
    CGAL::Exact_predicates_tag>>;

std::vector<Ring> cgal(const std::vector<Ring>& rings, std::size_t count) {
    Triangulation triangulation;
    for (const Ring& ring : rings) {
        CGAL::Polygon_2<Kernel> polygon;
        for (const Point& p : ring) polygon.push_back({p.x, p.y});
        triangulation.insert_constraint(polygon);
    }
    PS::simplify(triangulation, PS::Squared_distance_cost(), PS::Stop_below_count_threshold(count));
    std::vector<Ring> out;
    for (auto c = triangulation.constraints_begin(); c != triangulation.constraints_end(); ++c) {
        Ring ring;
        for (auto p = triangulation.points_in_constraint_begin(*c);
             p != triangulation.points_in_constraint_end(*c); ++p)
            ring.push_back({p->x(), p->y()});
        if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
        if (ring.size() >= 3) out.push_back(std::move(ring));
    }
    return out;
}

// ---- what is compared
// ---------------------------------------------------------------------------------------

std::vector<Segment> segmentsOfRings(const std::vector<Ring>& rings) {
    std::vector<Segment> segments;
    for (const Ring& ring : rings)
        for (std::size_t i = 0; i < ring.size(); ++i)
            segments.push_back({ring[i], ring[(i + 1) % ring.size()]});
    return segments;
}

bool cross(const Segment& s, const Segment& t) {
    const auto side = [](const Segment& a, Point p) { return isowave::curves2d::cross(a.b - a.a, p - a.a); };
    return side(s, t.a) * side(s, t.b) < 0 && side(t, s.a) * side(t, s.b) < 0;
}

// Rings that cross themselves or another one (touching does not count).
std::size_t invalidRings(const std::vector<Ring>& rings) {
    const std::vector<Segment> segments = segmentsOfRings(rings);
    std::vector<std::size_t> ringOf;
    for (std::size_t r = 0; r < rings.size(); ++r) ringOf.insert(ringOf.end(), rings[r].size(), r);
    const SegmentTree tree(segments);
    std::set<std::size_t> bad;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        Box box;
        box.take(segments[i].a);
        box.take(segments[i].b);
        tree.eachMeeting(box, [&](std::size_t j) {
            if (j > i && cross(segments[i], segments[j])) bad.insert({ringOf[i], ringOf[j]});
            return true;
        });
    }
    return bad.size();
}

std::int64_t differing(const Region& a, const Region& b) {
    std::int64_t both = 0;
    for (std::int32_t y = a.firstRow; y < a.endRow(); ++y) {
        const Spans &p = a.row(y), &q = b.row(y);
        for (std::size_t i = 0, j = 0; i < p.size() && j < q.size(); p[i].last < q[j].last ? ++i : ++j)
            both += std::max(0, std::min(p[i].last, q[j].last) - std::max(p[i].first, q[j].first) + 1);
    }
    return a.pointCount() + b.pointCount() - 2 * both;
}

struct Distances {
    double max = 0, rms = 0;
};
Distances distances(const std::vector<Segment>& from, const SegmentTree& to, double spacing) {
    Distances d;
    double sum = 0, weight = 0;
    for (const Segment& s : from) {
        const double size = length(s.b - s.a);
        const int parts = static_cast<int>(std::clamp(std::ceil(size / spacing), 1.0, 256.0));
        for (int k = 0; k < parts; ++k) {
            const double e = to.distance(s.a + ((k + 0.5) / parts) * (s.b - s.a));
            d.max = std::max(d.max, e);
            sum += e * e * size / parts;
        }
        weight += size;
    }
    d.rms = weight > 0 ? std::sqrt(sum / weight) : 0;
    return d;
}

class Judge {
  public:
    Judge(const std::vector<Polygon>& polygons, const std::vector<Ring>& rings, const Frame& frame)
        : frame_(frame),
          truth_(rasterise(polygons, fine())),
          segments_(segmentsOfRings(rings)),
          tree_(segments_) {}

    void row(const std::string& level, const std::string& name, const std::vector<Ring>& rings) const {
        std::size_t points = 0;
        for (const Ring& ring : rings) points += ring.size();
        const Region region = rasterise({Polygon{rings}}, fine());
        const double h = frame_.spacing.x;
        const std::vector<Segment> own = segmentsOfRings(rings);
        const Distances out = distances(own, tree_, h), in = distances(segments_, SegmentTree(own), h);
        const auto percent = [&](std::int64_t n) { return 100.0 * double(n) / double(truth_.pointCount()); };
        fmt::print("| {} | {} | {} | {} | {:+.3f} | {:.3f} | {:.2f} | {:.1f} | {:.1f} | {} |\n", level, name,
                   points, rings.size(), percent(region.pointCount() - truth_.pointCount()),
                   percent(differing(truth_, region)), out.rms / h, out.max / h, in.max / h,
                   invalidRings(rings));
        std::cout.flush();
    }

  private:
    // Four samples a pixel on each axis.
    Frame fine() const {
        const Point h = 0.25 * frame_.spacing;
        return {frame_.origin - 1.5 * h, h};
    }

    Frame frame_;
    Region truth_;
    std::vector<Segment> segments_;
    SegmentTree tree_;
};

Curves asCurves(const std::vector<Ring>& rings) {
    Curves curves;
    for (const Ring& ring : rings) curves.rings.push_back({ring, -1, false});
    return curves;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::cerr << "compare_curves POLYGONS [PIXELS [FOLDER]]\n";
        return 2;
    }
    const PolygonInput input = readPolygons(argv[1]);
    const auto pixels = static_cast<std::int32_t>(argc > 2 ? std::atoi(argv[2]) : 4096);
    std::vector<Ring> rings;
    for (const Polygon& polygon : input.polygons)
        rings.insert(rings.end(), polygon.rings.begin(), polygon.rings.end());

    InputOptions options;
    options.pixels = pixels;
    Input ready = readInput(argv[1], options);
    const View view{ready.extent, ready.yUp};
    const Judge judge(input.polygons, rings, ready.shape.frame);
    const Rank dp = douglasPeucker(rings), vw = visvalingam(rings);

    fmt::print(
        "{}; {} pixels; lengths in pixels\n\n"
        "| level | method | points | rings | area % | differing area % | rms to input | max to input | max "
        "from "
        "input | invalid rings |\n|---|---|---|---|---|---|---|---|---|---|\n",
        ready.kind, pixels);
    judge.row("", "the input", rings);
    climb(fit(ready.shape, Fit::distance), 12,
          [&](const StepFacts& facts, const RowField<float>&, const Curves& curves) {
              if (facts.step % 2 || facts.step == 0 || curves.rings.empty()) return;
              const std::string level = std::to_string(facts.step / 2);
              std::vector<Ring> own;
              for (std::size_t r = 0; r < curves.rings.size(); ++r) own.push_back(curves.world(r));
              const std::vector<std::pair<std::string, std::vector<Ring>>> all = {
                  {"isowave", own},
                  {"Douglas-Peucker", best(rings, dp, facts.points)},
                  {"Visvalingam", best(rings, vw, facts.points)},
                  {"CGAL, topology kept", cgal(rings, facts.points)}};
              for (const auto& [name, result] : all) {
                  judge.row(level, name, result);
                  if (argc > 3)
                      writePng(fmt::format("{}/L{}_{}.png", argv[3], level,
                                           name.substr(0, name.find_first_of(",-"))),
                               asCurves(result), view);
              }
          });
}
