// compare_curves POLYGONS [PIXELS [SHEET.svg LEVEL WEST SOUTH EAST NORTH]]: levels of `isowave curves` beside the
// line simplifications that people use, at equal numbers of points, as a markdown table. With a sheet, a picture of a
// window (the polygons' coordinates) at one level: the methods side by side, crossings marked.
//
//   Douglas-Peucker  points ranked by the distance at which the recursion would take them in
//   Visvalingam      points ranked by the area of the triangle that goes when they go (Visvalingam, Whyatt 1993)
//   CGAL             Polyline_simplification_2: Dyken et al. 2009, keeps the topology. GPL: this program only
//   thinned          the level before, whose rings are fewer, simplified by CGAL's to the same number of points
// A ring that has fewer than three points left is dropped, as the usual tools do.
//
//     cmake --preset release -DISOWAVE_BENCH=ON && cmake --build --preset release --target compare_curves
//     bench/fetch_coastlines coastlines && build/release/bin/compare_curves coastlines/land-10m.json 16384
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polyline_simplification_2/Squared_distance_cost.h>
#include <CGAL/Polyline_simplification_2/Stop_below_count_threshold.h>
#include <CGAL/Polyline_simplification_2/simplify.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <queue>
#include <set>

#include "curves2d/ladder.h"
#include "curves2d/polygon_input.h"
#include "curves2d/raster.h"

namespace {

using namespace isowave::curves2d;
using Rank = std::vector<std::vector<double>>;  // by ring and point: larger = kept longer

// ---- Douglas-Peucker

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

std::size_t pointsOf(const std::vector<Ring>& rings) {
    std::size_t points = 0;
    for (const Ring& ring : rings) points += ring.size();
    return points;
}

// The points of rank `least` and more, in rings of three and more.
std::vector<Ring> ofRank(const std::vector<Ring>& rings, const Rank& ranks, double least) {
    std::vector<Ring> out;
    for (std::size_t r = 0; r < rings.size(); ++r) {
        Ring ring;
        for (std::size_t i = 0; i < rings[r].size(); ++i)
            if (ranks[r][i] >= least) ring.push_back(rings[r][i]);
        if (ring.size() >= 3) out.push_back(std::move(ring));
    }
    return out;
}

// The highest ranks: as many that `count` points are left, or just more.
std::vector<Ring> best(const std::vector<Ring>& rings, const Rank& ranks, std::size_t count) {
    std::vector<double> all;
    for (const auto& rank : ranks) all.insert(all.end(), rank.begin(), rank.end());
    std::sort(all.begin(), all.end(), std::greater<>());
    // invariant: all[low - 1] leaves fewer than count points, all[high - 1] leaves count or is the last.
    std::size_t low = 0, high = all.size();
    while (high - low > 1) {
        const std::size_t middle = low + (high - low) / 2;
        (pointsOf(ofRank(rings, ranks, all[middle - 1])) < count ? low : high) = middle;
    }
    return ofRank(rings, ranks, all[high - 1]);
}

// ---- CGAL

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

Point meetingPoint(const Segment& s, const Segment& t) {
    const Point along = s.b - s.a, other = t.b - t.a;
    const double share = isowave::curves2d::cross(t.a - s.a, other) / isowave::curves2d::cross(along, other);
    return s.a + share * along;
}

// Where rings cross themselves or another one (touching does not count), and which ones do.
struct Crossings {
    std::vector<Point> places;
    std::set<std::size_t> rings;
};
Crossings crossingsOf(const std::vector<Ring>& rings) {
    const std::vector<Segment> segments = segmentsOfRings(rings);
    std::vector<std::size_t> ringOf;
    for (std::size_t r = 0; r < rings.size(); ++r) ringOf.insert(ringOf.end(), rings[r].size(), r);
    const SegmentTree tree(segments);
    Crossings found;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        Box box;
        box.take(segments[i].a);
        box.take(segments[i].b);
        tree.eachMeeting(box, [&](std::size_t j) {
            if (j > i && cross(segments[i], segments[j])) {
                found.rings.insert({ringOf[i], ringOf[j]});
                found.places.push_back(meetingPoint(segments[i], segments[j]));
            }
            return true;
        });
    }
    return found;
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
        const Region region = rasterise({Polygon{rings}}, fine());
        const double h = frame_.spacing.x;
        const std::vector<Segment> own = segmentsOfRings(rings);
        const Distances out = distances(own, tree_, h), in = distances(segments_, SegmentTree(own), h);
        const auto percent = [&](std::int64_t n) { return 100.0 * double(n) / double(truth_.pointCount()); };
        fmt::print("| {} | {} | {} | {} | {:+.2f} | {:.2f} | {:.2f} | {:.1f} | {:.1f} | {} |\n", level, name,
                   pointsOf(rings), rings.size(), percent(region.pointCount() - truth_.pointCount()),
                   percent(differing(truth_, region)), out.rms / h, out.max / h,
                   std::max(in.max, out.max) / h, crossingsOf(rings).rings.size());
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

// ---- the picture

struct Method {
    std::string name;
    std::vector<Ring> rings;
};

// Side by side, each clipped to the window, in quarters of a picture's point. A degree of longitude is drawn as long
// as it is in the window's middle.
void drawSheet(const std::string& path, const std::vector<Method>& methods, const Box& window) {
    constexpr double kSide = 400, kGap = 12, kLabel = 22, kUnits = 4;
    const Point size = window.high - window.low;
    const double narrow = std::cos((window.low.y + window.high.y) / 2 * std::acos(-1.0) / 180);
    const double scale = kUnits * kSide / size.y;
    const double width = kSide * size.x * narrow / size.y;
    const auto place = [&](Point p) {
        return fmt::format("{:.0f} {:.0f}", scale * narrow * (p.x - window.low.x),
                           scale * (window.high.y - p.y));
    };
    const auto meets = [&](const Ring& ring) {
        Box box;
        for (const Point& p : ring) box.take(p);
        return box.meets(window);
    };
    std::ofstream out(path);
    out << fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 0 "
        "{0:.0f} "
        "{1:.0f}\" font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" "
        "fill=\"white\"/>\n",
        kGap + (width + kGap) * double(methods.size()), kSide + kLabel + 2 * kGap);
    for (std::size_t m = 0; m < methods.size(); ++m) {
        const double x = kGap + double(m) * (width + kGap);
        out << fmt::format(
            "<svg x=\"{:.0f}\" y=\"{}\" width=\"{:.0f}\" height=\"{}\" viewBox=\"0 0 {:.0f} {:.0f}\"><rect "
            "width=\"100%\" height=\"100%\" fill=\"#e8eef4\"/><path fill=\"#c9b88a\" stroke=\"#1d3557\" "
            "stroke-width=\"4\" fill-rule=\"evenodd\" d=\"",
            x, kGap, width, kSide, kUnits * width, kUnits * kSide);
        for (const Ring& ring : methods[m].rings) {
            if (!meets(ring)) continue;
            for (std::size_t i = 0; i < ring.size(); ++i) out << (i ? "L" : "M") << place(ring[i]);
            out << "Z\n";
        }
        out << "\"/>";
        for (const Point& p : crossingsOf(methods[m].rings).places) {
            if (p.x < window.low.x || p.x > window.high.x || p.y < window.low.y || p.y > window.high.y)
                continue;
            const std::string at = place(p);
            const std::size_t gap = at.find(' ');
            out << fmt::format(
                "<circle cx=\"{}\" cy=\"{}\" r=\"26\" fill=\"none\" stroke=\"#d00000\" stroke-width=\"7\"/>",
                at.substr(0, gap), at.substr(gap + 1));
        }
        out << fmt::format("</svg>\n<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\">{}</text>\n",
                           x + width / 2, kGap + kSide + 17, methods[m].name);
    }
    out << "</svg>\n";
}

struct Sheet {
    std::string path;
    int level = 0;
    Box window;
};

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3 && argc != 9) {
        std::cerr << "compare_curves POLYGONS [PIXELS [SHEET.svg LEVEL WEST SOUTH EAST NORTH]]\n";
        return 2;
    }
    const PolygonInput input = readPolygons(argv[1]);
    const auto pixels = static_cast<std::int32_t>(argc > 2 ? std::atoi(argv[2]) : 4096);
    Sheet sheet;
    if (argc > 3) {
        sheet = {argv[3], std::atoi(argv[4]), {}};
        sheet.window.take(Point{std::atof(argv[5]), std::atof(argv[6])});
        sheet.window.take(Point{std::atof(argv[7]), std::atof(argv[8])});
    }
    std::vector<Ring> rings;
    for (const Polygon& polygon : input.polygons)
        rings.insert(rings.end(), polygon.rings.begin(), polygon.rings.end());

    InputOptions options;
    options.pixels = pixels;
    const Input ready = readInput(argv[1], options);
    const Judge judge(input.polygons, rings, ready.shape->frame);
    const Rank dp = douglasPeucker(rings), vw = visvalingam(rings);

    fmt::print(
        "{}; {} pixels; lengths in pixels\n\n"
        "| level | method | points | rings | area % | differing area % | rms | max | Hausdorff | invalid "
        "rings |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n",
        ready.kind, pixels);
    judge.row("", "the input", rings);
    constexpr int kLastLevel = 6;
    std::vector<Ring> before;
    traceSteps(fit(*ready.shape, Fit::distance), 2 * kLastLevel, Hold::none,
               [&](const StepFacts& facts, const RowField<float>&, const Curves& curves, const Curves&) {
                   if (facts.step % 2 || curves.rings.empty()) return;
                   const std::string level = std::to_string(facts.step / 2);
                   std::vector<Ring> own;
                   for (std::size_t r = 0; r < curves.rings.size(); ++r) own.push_back(curves.world(r));
                   if (!before.empty() && facts.points < pointsOf(rings)) {
                       const std::vector<Method> methods = {
                           {"isowave", own},
                           {"isowave, thinned", cgal(before, facts.points)},
                           {"Douglas-Peucker", best(rings, dp, facts.points)},
                           {"Visvalingam", best(rings, vw, facts.points)},
                           {"CGAL", cgal(rings, facts.points)}};
                       for (const Method& method : methods) {
                           // Below three points a ring CGAL does not go: then it has not what is compared.
                           if (pointsOf(method.rings) > facts.points + facts.points / 10)
                               fmt::print("| {} | {} | not below {} | | | | | | | |\n", level, method.name,
                                          pointsOf(method.rings));
                           else
                               judge.row(level, method.name, method.rings);
                       }
                       if (facts.step == 2 * sheet.level && !sheet.path.empty())
                           drawSheet(sheet.path, methods, sheet.window);
                   }
                   before = std::move(own);
               });
}
