#include "curves2d/fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

#include "curves2d/segment_tree.h"
#include "curves2d/three_rows.h"

namespace isowave::curves2d {
namespace {

// ---- which control points are known ----

// Positions in exactly one of the two: where an odd number of the four kinds of ends has passed.
Spans symmetricDifference(const Spans& a, const Spans& b) {
    std::vector<std::int32_t> ends;
    ends.reserve(2 * (a.size() + b.size()));
    for (const Spans* spans : {&a, &b})
        for (const Span& span : *spans) {
            ends.push_back(span.first);
            ends.push_back(span.last + 1);
        }
    std::sort(ends.begin(), ends.end());
    Spans out;
    for (std::size_t i = 0; i < ends.size(); i += 2)
        if (ends[i] < ends[i + 1]) out.push_back({ends[i], ends[i + 1] - 1});
    normalise(out);
    return out;
}

// Lattice points of a row that are nearer than `radius` to a segment: the part of the row inside a capsule,
// which is convex. It is the hull of what the two discs and the parallelogram between them cut out.
struct RowPart {
    double low = INFINITY, high = -INFINITY;
    void take(double x) {
        low = std::min(low, x);
        high = std::max(high, x);
    }
};
RowPart capsuleOnRow(const Segment& s, double radius, double row) {
    RowPart part;
    for (const Point& end : {s.a, s.b}) {
        const double dy = row - end.y, under = radius * radius - dy * dy;
        if (under < 0) continue;
        part.take(end.x - std::sqrt(under));
        part.take(end.x + std::sqrt(under));
    }
    const Point along = s.b - s.a;
    const double size = length(along);
    if (size == 0 || along.y == 0) return part;
    const Point normal{-radius * along.y / size, radius * along.x / size};
    for (const Point& offset : {normal, -1 * normal}) {
        const double t = (row - s.a.y - offset.y) / along.y;
        if (t >= 0 && t <= 1) part.take(s.a.x + offset.x + t * along.x);
    }
    return part;
}

template <class F>  // f(row, RowPart): for every row that the capsule meets
void forEachCapsuleRow(const Segment& s, double radius, const F& f) {
    const auto first = static_cast<std::int32_t>(std::ceil(std::min(s.a.y, s.b.y) - radius));
    const auto last = static_cast<std::int32_t>(std::floor(std::max(s.a.y, s.b.y) + radius));
    for (std::int32_t row = first; row <= last; ++row) {
        const RowPart part = capsuleOnRow(s, radius, row);
        if (part.low <= part.high) f(row, part);
    }
}

// Nodes with a corner nearer than `band` to the boundary.
Region nodesNear(const std::vector<Segment>& segments, double band) {
    if (segments.empty()) return {};
    double low = INFINITY, high = -INFINITY;
    for (const Segment& s : segments) {
        low = std::min({low, s.a.y, s.b.y});
        high = std::max({high, s.a.y, s.b.y});
    }
    Region corners = withRows(static_cast<std::int32_t>(std::floor(low - band)),
                              static_cast<std::int32_t>(std::ceil(high + band)));
    for (const Segment& s : segments)
        forEachCapsuleRow(s, band, [&](std::int32_t row, const RowPart& part) {
            const Span span{static_cast<std::int32_t>(std::ceil(part.low)),
                            static_cast<std::int32_t>(std::floor(part.high))};
            if (span.first <= span.last)
                corners.rows[static_cast<std::size_t>(row - corners.firstRow)].push_back(span);
        });
    for (Spans& row : corners.rows) normalise(row);
    return dilated(corners, 1, 0);
}

// The part of the boundary that separates inside lattice points from outside ones: the pieces in stabbed nodes and in
// their neighbours. The other pieces are both sides of a slit, spikes, overlaps and islands between the lattice points.
// There the distance is 0 but the sign does not change, and the coarser levels of such a field would have specks (seen:
// holes 500 pixels from the nearest coast, along a seam of the data).
std::vector<Segment> separating(const std::vector<Segment>& boundary, const Region& stabbed) {
    const Region near = dilated(stabbed, 1, 1);
    std::vector<Segment> out;
    for (const Segment& s : boundary) {
        const int parts = std::max(1, static_cast<int>(std::ceil(length(s.b - s.a))));
        bool open = false;
        for (int k = 0; k < parts; ++k) {
            const Point from = s.a + (double(k) / parts) * (s.b - s.a),
                        to = k + 1 == parts ? s.b : s.a + (double(k + 1) / parts) * (s.b - s.a);
            const Point middle = 0.5 * (from + to);
            const bool keep = near.contains(static_cast<std::int32_t>(std::floor(middle.x)),
                                            static_cast<std::int32_t>(std::floor(middle.y)));
            if (keep && open)
                out.back().b = to;
            else if (keep)
                out.push_back({from, to});
            open = keep;
        }
    }
    out.shrink_to_fit();
    return out;
}

// ---- origin ----

void shiftRegion(Region& region, std::int32_t dx, std::int32_t dy) {
    region.firstRow += dy;
    for (Spans& row : region.rows)
        for (Span& span : row) span = {span.first + dx, span.last + dx};
}

// Halving a domain that lies at -1 and above ends at one node, control points -1 .. 2. A domain that straddles the
// origin halves to -2 .. 2, two nodes, and stays there.
void moveOrigin(Region& known, Shape& shape) {
    std::int32_t low[2] = {-1, -1};
    for (std::int32_t y = known.firstRow; y < known.endRow(); ++y) {
        if (known.row(y).empty()) continue;
        low[0] = std::min(low[0], known.row(y).front().first);
        low[1] = std::min(low[1], y);
    }
    const std::int32_t dx = -1 - low[0], dy = -1 - low[1];
    shiftRegion(known, dx, dy);
    shiftRegion(shape.inside, dx, dy);
    for (Segment& s : shape.boundary)
        for (Point* p : {&s.a, &s.b}) *p = *p + Point{double(dx), double(dy)};
    shape.frame.origin = shape.frame.toWorld({-double(dx), -double(dy)});
}

// ---- field ----

// Control points of ±K by sign on I.
template <class Real>
RowField<Real> makeField(const Region& known, const Shape& shape, double K) {
    RowField<Real> field;
    field.K = K;
    field.frame = shape.frame;
    for (std::int32_t y = known.firstRow; y < known.endRow(); ++y) {
        if (known.row(y).empty()) continue;
        Row<Real>& row = field.rows[y];
        SpanCursor inside(shape.inside.row(y));
        std::size_t size = 0;
        for (const Span& span : known.row(y)) size += static_cast<std::size_t>(span.last - span.first + 1);
        row.values.reserve(size);
        for (const Span& span : known.row(y)) {
            for (std::int32_t x = span.first; x <= span.last; ++x)
                row.values.push_back(static_cast<Real>(inside.contains(x) ? -K : K));
            row.runs.push_back({span.first, span.last, inside.contains(span.last + 1)});
        }
    }
    return field;
}

// New values for some rows of a field, computed from the old ones in parallel, then put in their place.
// compute(row number, row, values): values has been copied from the row.
template <class Real, class Compute>
void updateRows(RowField<Real>& field, const std::vector<std::int32_t>& numbers, const Progress& progress,
                const Compute& compute) {
    std::vector<std::vector<Real>> made(numbers.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, numbers.size(), 16), [&](const auto& range) {
        progress.check();
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const Row<Real>& row = *field.find(numbers[i]);
            made[i] = row.values;
            compute(numbers[i], row, made[i]);
        }
    });
    for (std::size_t i = 0; i < numbers.size(); ++i) field.rows[numbers[i]].values = std::move(made[i]);
}

// ---- smooth ----

// c <- (c + mean of the four neighbours)/2, all at once.
template <class Real>
void laplacianPass(RowField<Real>& field, const std::vector<std::int32_t>& numbers,
                   const Progress& progress) {
    updateRows(
        field, numbers, progress, [&](std::int32_t y, const Row<Real>& row, std::vector<Real>& values) {
            ThreeRows<Real> c(field, y);
            std::size_t v = 0;
            for (const KnownRun& run : row.runs) {
                c.read(run.first, run.last);
                for (std::size_t i = 1; i + 1 < c.here.size(); ++i)
                    values[v++] = static_cast<Real>(
                        0.5 * (c.here[i] + (c.here[i - 1] + c.here[i + 1] + c.below[i] + c.above[i]) / 4));
            }
        });
}

// ---- repair ----

// Calls f(x, s, F, value index) for every known lattice point of a row; s: the input's sign, F: the spline.
template <class Real, class F>
void forEachLatticeValue(const RowField<Real>& field, const Region& inside, std::int32_t y, const F& f) {
    ThreeRows<Real> c(field, y);
    SpanCursor cursor(inside.row(y));
    std::vector<double> values;
    std::size_t v = 0;
    for (const KnownRun& run : field.find(y)->runs) {
        c.read(run.first, run.last);
        threeTaps(c, 4.0 / 6, 1.0 / 6, values);
        for (std::int32_t x = run.first; x <= run.last; ++x, ++v)
            f(x, cursor.contains(x) ? -1.0 : 1.0, values[static_cast<std::size_t>(x - run.first)], v);
    }
}

// While a lattice point of I has s F < floor: c <- c + target s - F, which moves F there by (2/3)^2 of that.
// Rows whose neighbourhood did not change in the last pass are skipped. floor, target: fractions of K.
template <class Real>
void repair(RowField<Real>& field, const Region& inside, double floor, double target, FitReport& report,
            const Progress& progress) {
    // White noise at 50 % takes some 20 passes; many times that means that the repair cannot succeed.
    constexpr int kMostPasses = 1000;
    report.repairFloor = floor;
    floor *= field.K;
    target *= field.K;
    std::vector<std::int32_t> active = field.rowNumbers();
    for (int pass = 0; pass < kMostPasses && !active.empty(); ++pass) {
        std::atomic<std::int64_t> count{0};
        std::vector<std::int32_t> numbers = std::move(active);
        std::vector<char> changed(numbers.size(), 0);
        updateRows(
            field, numbers, progress, [&](std::int32_t y, const Row<Real>&, std::vector<Real>& values) {
                std::int64_t here = 0;
                forEachLatticeValue(field, inside, y, [&](std::int32_t, double s, double F, std::size_t v) {
                    if (s * F >= floor) return;
                    values[v] = static_cast<Real>(static_cast<double>(values[v]) + target * s - F);
                    ++here;
                });
                if (!here) return;
                changed[static_cast<std::size_t>(std::lower_bound(numbers.begin(), numbers.end(), y) -
                                                 numbers.begin())] = 1;
                count += here;
            });
        if (count == 0) return;
        report.repaired += count;
        ++report.repairPasses;
        active.clear();
        for (std::size_t i = 0; i < numbers.size(); ++i)
            for (int d = -1; changed[i] && d <= 1; ++d)
                if (field.find(numbers[i] + d)) active.push_back(numbers[i] + d);
        std::sort(active.begin(), active.end());
        active.erase(std::unique(active.begin(), active.end()), active.end());
    }
    report.repairAgreed = active.empty();
}

template <class Real>
void countDisagreement(const RowField<Real>& field, const Region& inside, FitReport& report) {
    for (const auto& [y, row] : field.rows)
        forEachLatticeValue(field, inside, y, [&](std::int32_t, double s, double F, std::size_t) {
            ++report.latticePoints;
            report.disagreeing += (s < 0) != (F < 0);
        });
}

// The sign is what E section 2 asks for; the margin keeps it when the field is next filtered or stored.
constexpr double kBinaryFloor = 0.05, kBinaryTarget = 0.1;

// Where a distance fit has the wrong sign at all, it is within a hundredth of a step of the right one, so the repair
// moves it as little as suffices. Both in lattice steps.
constexpr double kDistanceFloor = 1e-4, kDistanceTarget = 2e-4;

template <class Real>
void finish(RowField<Real>& field, const Shape& shape, double floor, double target, FitReport* report,
            const Progress& progress) {
    progress("fitting", 0.6);
    FitReport result;
    repair(field, shape.inside, floor, target, result, progress);
    countDisagreement(field, shape.inside, result);
    progress("fitting", 1);
    if (report) *report = result;
}

// ---- distances ----

// Signed distance to the boundary on the lattice points `where`, clamped to ±w and scaled so that ±w is ±K.
RowField<float> distances(const Region& where, const Shape& shape, double w, double K,
                          const Progress& progress) {
    RowField<float> d = makeField<float>(where, shape, w * w);
    for (auto row = d.rows.begin(); row != d.rows.end(); ++row)
        for (float& v : row.value().values) v = std::abs(v);
    // Where the values of each run of a row begin.
    tsl::robin_map<std::int32_t, std::vector<std::size_t>> starts;
    for (const auto& [y, row] : d.rows) {
        std::size_t v = 0;
        for (const KnownRun& run : row.runs) {
            starts[y].push_back(v);
            v += static_cast<std::size_t>(run.last - run.first + 1);
        }
    }
    std::size_t done = 0;
    for (const Segment& s : shape.boundary) {
        if (done++ % 65536 == 0)
            progress("distances", static_cast<double>(done) / static_cast<double>(shape.boundary.size()));
        forEachCapsuleRow(s, w, [&](std::int32_t y, const RowPart& part) {
            const auto at = d.rows.find(y);
            if (at == d.rows.end()) return;
            Row<float>& row = at.value();
            const std::vector<std::size_t>& start = starts.find(y)->second;
            const auto low = static_cast<std::int32_t>(std::ceil(part.low)),
                       high = static_cast<std::int32_t>(std::floor(part.high));
            auto run = std::lower_bound(row.runs.begin(), row.runs.end(), low,
                                        [](const KnownRun& r, std::int32_t x) { return r.last < x; });
            for (; run != row.runs.end() && run->first <= high; ++run) {
                float* values = row.values.data() + start[static_cast<std::size_t>(run - row.runs.begin())];
                for (std::int32_t x = std::max(run->first, low); x <= std::min(run->last, high); ++x) {
                    float& value = values[x - run->first];
                    value = std::min(value, static_cast<float>(squaredDistance({double(x), double(y)}, s)));
                }
            }
        });
    }
    for (auto at = d.rows.begin(); at != d.rows.end(); ++at) {
        Row<float>& row = at.value();
        SpanCursor inside(shape.inside.row(at->first));
        std::size_t v = 0;
        for (const KnownRun& run : row.runs)
            for (std::int32_t x = run.first; x <= run.last; ++x, ++v)
                row.values[v] =
                    static_cast<float>((inside.contains(x) ? -K : K) * std::sqrt(row.values[v]) / w);
    }
    d.K = K;
    return d;
}

}  // namespace

void repairSigns(RowField<float>& field, const Region& inside, Fit method, double halfWidth,
                 FitReport& report, const Progress& progress) {
    const Shape shape{field.frame, inside, {}};
    if (method == Fit::binary)
        finish(field, shape, kBinaryFloor, kBinaryTarget, &report, progress);
    else
        finish(field, shape, kDistanceFloor / halfWidth, kDistanceTarget / halfWidth, &report, progress);
}

// A node between rows y and y+1 is stabbed where the sign changes along either row or between them.
Region stabbedNodes(const Region& inside) {
    Region nodes = withRows(inside.firstRow - 1, inside.endRow() - 1);
    if (inside.rows.empty()) return {};
    for (std::int32_t y = nodes.firstRow; y < nodes.endRow(); ++y) {
        Spans& out = nodes.rows[static_cast<std::size_t>(y - nodes.firstRow)];
        for (const Spans* row : {&inside.row(y), &inside.row(y + 1)})
            for (const Span& span : *row) {
                out.push_back({span.first - 1, span.first - 1});
                out.push_back({span.last, span.last});
            }
        for (const Span& span : symmetricDifference(inside.row(y), inside.row(y + 1)))
            out.push_back({span.first - 1, span.last});
        normalise(out);
    }
    return nodes;
}

Region knownAround(const Region& nodes) { return dilated(nodes, 1, 2); }

template <class Real>
RowField<Real> fitBinary(const Shape& shape, const BinaryFitOptions& options, FitReport* report,
                         const Progress& progress) {
    progress("fitting", 0);
    Shape moved{shape.frame, shape.inside, {}};
    Region known = knownAround(stabbedNodes(shape.inside));
    moveOrigin(known, moved);
    RowField<Real> field = makeField<Real>(known, moved, options.K);
    const std::vector<std::int32_t> numbers = field.rowNumbers();
    for (int pass = 0; pass < options.passes; ++pass) laplacianPass(field, numbers, progress);
    finish(field, moved, kBinaryFloor, kBinaryTarget, report, progress);
    return field;
}

template <class Real>
RowField<Real> fitDistance(const Shape& shape, const DistanceFitOptions& options, FitReport* report,
                           const Progress& progress) {
    assert(0 < options.band && options.band <= options.halfWidth);
    progress("fitting", 0);
    const Region stabbed = stabbedNodes(shape.inside);
    Shape moved{shape.frame, shape.inside, separating(shape.boundary, stabbed)};
    Region known = knownAround(unite(stabbed, nodesNear(moved.boundary, options.band)));
    moveOrigin(known, moved);
    const double w = options.halfWidth;
    const RowField<float> v = distances(dilated(known, 1, 1), moved, w, options.K, progress);
    RowField<Real> field = makeField<Real>(known, moved, options.K);
    updateRows(field, field.rowNumbers(), progress,
               [&](std::int32_t y, const Row<Real>& row, std::vector<Real>& values) {
                   ThreeRows<float> near(v, y);
                   std::vector<double> c;
                   auto write = values.begin();
                   for (const KnownRun& run : row.runs) {
                       near.read(run.first, run.last);
                       threeTaps(near, 8.0 / 6, -1.0 / 6, c);
                       write = std::transform(c.begin(), c.end(), write,
                                              [](double x) { return static_cast<Real>(x); });
                   }
               });
    finish(field, moved, kDistanceFloor / w, kDistanceTarget / w, report, progress);
    return field;
}

#define ISOWAVE_INSTANTIATE(Real)                                                                          \
    template RowField<Real> fitBinary(const Shape&, const BinaryFitOptions&, FitReport*, const Progress&); \
    template RowField<Real> fitDistance(const Shape&, const DistanceFitOptions&, FitReport*, const Progress&);
ISOWAVE_INSTANTIATE(float)
ISOWAVE_INSTANTIATE(double)
#undef ISOWAVE_INSTANTIATE

}  // namespace isowave::curves2d
