#include "curves2d/contour.h"

#include <algorithm>
#include <cassert>
#include <utility>

// Passes over one row of unit squares after the other:
//   evaluate   the spline at the lattice points of two rows, near what is known
//   place      a crossing on every lattice edge whose ends differ in sign
//   connect    the crossings of a square: next[crossing] = crossing, inside to the left
// then over all crossings:
//   trace      next is a permutation; its cycles are the rings
//   nest       along every lattice row, from left to right, crossings open and close rings like brackets

namespace isowave::curves2d {
namespace {

constexpr double kFromCorner = 1e-3;
constexpr double kRootWidth = 1e-12;

// A root in [0, 1] of the cubic with spline control points c; its signs at 0 and 1 differ, negative at 0 if
// negativeAtZero. Newton where it stays inside the bracket, halving where not. Of three roots, any.
double rootOnEdge(const std::array<double, 4>& c, bool negativeAtZero) {
    double low = 0, high = 1, t = 0.5;
    const auto dot4 = [&c](const std::array<double, 4>& w) {
        return w[0] * c[0] + w[1] * c[1] + w[2] * c[2] + w[3] * c[3];
    };
    for (int i = 0; i < 100 && high - low > kRootWidth; ++i) {
        const double value = dot4(splineWeights(t)), slope = dot4(splineSlopes(t));
        ((value < 0) == negativeAtZero ? low : high) = t;
        const double newton = t - value / slope;
        const bool inside = newton > low && newton < high;
        const double before = t;
        t = inside ? newton : 0.5 * (low + high);
        if (inside && std::abs(t - before) < kRootWidth) break;
    }
    return std::clamp(t, kFromCorner, 1 - kFromCorner);
}

using Vertex = std::int32_t;
constexpr Vertex kNone = -1;

// A crossing on a lattice row, by the lattice point before it.
struct Crossing {
    std::int32_t x;
    Vertex vertex;
};

template <class Real>
class Tracer {
  public:
    explicit Tracer(const RowField<Real>& field) : field_(field) {}

    Curves run(const Progress& progress) {
        const std::vector<std::int32_t> rows = squareRows();
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (i % 256 == 0)
                progress("extracting", static_cast<double>(i) / static_cast<double>(rows.size()));
            if (i == 0 || rows[i - 1] + 1 != rows[i]) below_.clear();
            squareRow(rows[i]);
        }
        Curves curves;
        curves.frame = field_.frame;
        trace(curves);
        nest(curves);
        return curves;
    }

  private:
    // Rows of squares (by their lower side) in which a known control point has a weight.
    std::vector<std::int32_t> squareRows() const {
        std::vector<std::int32_t> rows;
        for (const std::int32_t y : field_.rowNumbers())
            for (std::int32_t r = y - 2; r <= y + 1; ++r) rows.push_back(r);
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        return rows;
    }

    // Lattice points where the spline may differ from the sign of an unknown point, and one more at either
    // end.
    Spans spansOf(std::int32_t y) const {
        Spans spans;
        for (std::int32_t r = y - 1; r <= y + 2; ++r)
            if (const Row<Real>* row = field_.find(r))
                for (const KnownRun& run : row->runs) spans.push_back({run.first - 2, run.last + 2});
        normalise(spans);
        return spans;
    }

    // Control points of rows y-1 .. y+2 at first-1 .. last+1, filtered along one axis and along both.
    struct Block {
        std::array<std::vector<double>, 4> c;  // control points
        std::array<std::vector<double>, 2> e;  // on rows y, y+1, filtered across: cubics along the row
        std::array<std::vector<double>, 2> F;  // the spline at lattice points of rows y, y+1

        void filter() {
            for (std::size_t k = 0; k < 2; ++k) {
                e[k].resize(c[0].size());
                for (std::size_t i = 0; i < e[k].size(); ++i)
                    e[k][i] = (c[k][i] + 4 * c[k + 1][i] + c[k + 2][i]) / 6;
                F[k].assign(e[k].size(), 0);
                for (std::size_t i = 1; i + 1 < e[k].size(); ++i)
                    F[k][i] = (e[k][i - 1] + 4 * e[k][i] + e[k][i + 1]) / 6;
            }
        }
        std::array<double, 4> alongRow(std::size_t k, std::size_t i) const {
            return {e[k][i - 1], e[k][i], e[k][i + 1], e[k][i + 2]};
        }
        std::array<double, 4> acrossRows(std::size_t i) const {
            std::array<double, 4> g;
            for (std::size_t k = 0; k < 4; ++k) g[k] = (c[k][i - 1] + 4 * c[k][i] + c[k][i + 1]) / 6;
            return g;
        }
        bool centreInside(std::size_t i) const {
            double value = 0;
            for (std::size_t k = 0; k < 4; ++k) {
                const double f = c[k][i - 1] + 23 * c[k][i] + 23 * c[k][i + 1] + c[k][i + 2];
                value += (k == 0 || k == 3 ? 1 : 23) * f;
            }
            return value < 0;
        }
    };

    void squareRow(std::int32_t y) {
        std::array<RowReader<Real>, 4> readers{
            RowReader<Real>(field_.find(y - 1), field_.K), RowReader<Real>(field_.find(y), field_.K),
            RowReader<Real>(field_.find(y + 1), field_.K), RowReader<Real>(field_.find(y + 2), field_.K)};
        std::vector<Crossing> above;
        std::size_t belowCursor = 0;
        for (const Span& span : spansOf(y)) {
            for (std::size_t k = 0; k < 4; ++k) {
                block_.c[k].resize(static_cast<std::size_t>(span.last - span.first + 3));
                readers[k].read(span.first - 1, block_.c[k]);
            }
            block_.filter();
            Vertex left = kNone;
            for (std::int32_t x = span.first; x < span.last; ++x) {
                const auto i = static_cast<std::size_t>(x - span.first + 1);
                const bool s00 = block_.F[0][i] < 0, s10 = block_.F[0][i + 1] < 0, s01 = block_.F[1][i] < 0,
                           s11 = block_.F[1][i + 1] < 0;
                Vertex bottom = kNone, top = kNone, right = kNone;
                if (s00 != s10) {
                    while (below_[belowCursor].x < x) ++belowCursor;
                    assert(below_[belowCursor].x == x);
                    bottom = below_[belowCursor].vertex;
                }
                if (s01 != s11) {
                    top = add({x + rootOnEdge(block_.alongRow(1, i), s01), double(y + 1)});
                    above.push_back({x, top});
                    rowCrossings_.push_back({y + 1, top});
                }
                if (s10 != s11) right = add({double(x + 1), y + rootOnEdge(block_.acrossRows(i + 1), s10)});
                connect({bottom, right, top, left}, {s00, s10, s11, s01}, i);
                left = right;
            }
        }
        below_ = std::move(above);
    }

    Vertex add(Point p) {
        points_.push_back(p);
        next_.push_back(kNone);
        return static_cast<Vertex>(points_.size() - 1);
    }

    // edges: bottom, right, top, left; corners in the same turning sense, edge k from corner k to corner k+1.
    // A piece with inside at its left starts where the border of the square leaves the inside and ends where
    // it comes back in. In a square with two pieces the spline's sign in the middle decides which pairs:
    // inside joined through the middle, the pieces cut off the outside corners, that is, go on to the next
    // edge.
    void connect(const std::array<Vertex, 4>& edges, const std::array<bool, 4>& corners, std::size_t i) {
        const bool two = corners[0] == corners[2] && corners[1] == corners[3] && corners[0] != corners[1];
        for (std::size_t k = 0; k < 4; ++k) {
            if (edges[k] == kNone || !corners[k]) continue;
            std::size_t to = (k + 1) % 4;
            if (two) {
                if (!block_.centreInside(i)) to = (k + 3) % 4;
            } else {
                while (edges[to] == kNone) to = (to + 1) % 4;
            }
            next_[static_cast<std::size_t>(edges[k])] = edges[to];
        }
    }

    void trace(Curves& curves) {
        ringOf_.assign(points_.size(), kNone);
        for (std::size_t start = 0; start < points_.size(); ++start) {
            if (ringOf_[start] != kNone) continue;
            CurveRing ring;
            for (auto v = start; ringOf_[v] == kNone; v = static_cast<std::size_t>(next_[v])) {
                ringOf_[v] = static_cast<Vertex>(curves.rings.size());
                ring.points.push_back(points_[v]);
                assert(next_[v] != kNone);
            }
            ring.hole = signedArea(ring.points) < 0;
            curves.rings.push_back(std::move(ring));
        }
    }

    // The rings around a point form a chain. A walk along a row that passes a crossing of ring r either enters r,
    // directly inside the innermost ring around the walk so far, or leaves r, which then was the innermost: nothing
    // that lies inside r reaches r's curve. So a stack holds the chain.
    void nest(Curves& curves) {
        std::vector<Vertex> open;
        for (std::size_t i = 0; i < rowCrossings_.size(); ++i) {
            if (i > 0 && rowCrossings_[i].x != rowCrossings_[i - 1].x) {
                assert(open.empty());
                open.clear();
            }
            const Vertex ring = ringOf_[static_cast<std::size_t>(rowCrossings_[i].vertex)];
            if (!open.empty() && open.back() == ring) {
                open.pop_back();
            } else {
                curves.rings[static_cast<std::size_t>(ring)].parent = open.empty() ? -1 : open.back();
                open.push_back(ring);
            }
        }
    }

    const RowField<Real>& field_;
    Block block_;
    std::vector<Point> points_;
    std::vector<Vertex> next_, ringOf_;
    std::vector<Crossing> below_;         // crossings on the lower side of the row of squares, ascending
    std::vector<Crossing> rowCrossings_;  // x holds the row here: all crossings on lattice rows, in order
};

// ---- between the crossings ----

// The field near one piece, in world coordinates.
template <class Real>
class ZeroSet {
  public:
    ZeroSet(const RowField<Real>& field, const Frame& frame) : field_(field), frame_(frame) {}

    struct Local {
        double value;
        Point gradient;
    };
    Local at(Point world) const {
        const Sample s = sample(field_, frame_.toLattice(world));
        return {s.value, {s.gradient.x / frame_.spacing.x, s.gradient.y / frame_.spacing.y}};
    }
    // First-order distance to the zero set.
    double distance(Point world) const {
        const Local local = at(world);
        const double slope = length(local.gradient);
        return slope > 0 ? std::abs(local.value) / slope : INFINITY;
    }
    // Along the zero set, inside to the left: the gradient points outside, to the right.
    Point tangent(Point world, Point otherwise) const {
        const Point g = at(world).gradient;
        const double slope = length(g);
        return slope > 0 ? Point{-g.y / slope, g.x / slope} : otherwise;
    }
    // Newton along the gradient, which must end inside the unit square with lower corner `square`.
    bool project(Point& world, Point square) const {
        for (int i = 0; i < 30; ++i) {
            const Local local = at(world);
            const double slope2 = dot(local.gradient, local.gradient);
            if (!(slope2 > 0)) return false;
            const Point move = (-local.value / slope2) * local.gradient;
            world = world + move;
            const Point p = frame_.toLattice(world) - square;
            constexpr double margin = 1e-6;
            if (!(p.x > margin && p.x < 1 - margin && p.y > margin && p.y < 1 - margin)) return false;
            if (length(move) < 1e-12 * std::max(frame_.spacing.x, frame_.spacing.y)) return true;
        }
        return distance(world) < 1e-9 * std::max(frame_.spacing.x, frame_.spacing.y);
    }

  private:
    const RowField<Real>& field_;
    Frame frame_;
};

// The unit square that a piece between two crossings lies in.
Point squareOf(Point a, Point b) { return {std::floor((a.x + b.x) / 2), std::floor((a.y + b.y) / 2)}; }

// Halving a piece ten times makes it a thousandth of a lattice step long.
constexpr int kMostHalvings = 10;

constexpr double kSampledAt[] = {1. / 8, 2. / 8, 3. / 8, 4. / 8, 5. / 8, 6. / 8, 7. / 8};

// Adds points of the zero set strictly between a and b until the polyline is within the tolerance; false when the zero
// set could not be followed.
template <class Real>
bool addPointsBetween(const ZeroSet<Real>& zeros, Point a, Point b, Point square, double tolerance,
                      int halvings, Ring& out) {
    bool good = true;
    for (const double t : kSampledAt) good = good && zeros.distance(a + t * (b - a)) <= tolerance;
    if (good) return true;
    Point middle = 0.5 * (a + b);
    if (halvings == 0 || !zeros.project(middle, square)) return false;
    if (!addPointsBetween(zeros, a, middle, square, tolerance, halvings - 1, out)) return false;
    out.push_back(middle);
    return addPointsBetween(zeros, middle, b, square, tolerance, halvings - 1, out);
}

int turn(Point a, Point b, Point c) {
    const double area = cross(b - a, c - a);
    return (area > 0) - (area < 0);
}

// Whether an open chain of a few points crosses or touches itself.
bool isSimple(const Ring& chain) {
    for (std::size_t i = 0; i + 1 < chain.size(); ++i)
        for (std::size_t j = i + 2; j + 1 < chain.size(); ++j)
            if (turn(chain[i], chain[i + 1], chain[j]) != turn(chain[i], chain[i + 1], chain[j + 1]) &&
                turn(chain[j], chain[j + 1], chain[i]) != turn(chain[j], chain[j + 1], chain[i + 1]))
                return false;
    return true;
}

template <class Real>
bool hasTwoPieces(const RowField<Real>& field, Point square) {
    bool inside[4];
    for (int k = 0; k < 4; ++k)
        inside[k] = sample(field, {square.x + (k == 1 || k == 2), square.y + (k >= 2)}).value < 0;
    return inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1];
}

// A Bézier with the given end tangents. For an arc of angle a, handles of chord/(3 cos^2(a/4)) are right to
// the sixth order.
Bezier hermite(Point a, Point b, Point ta, Point tb) {
    const double cosine = std::clamp(dot(ta, tb), -1.0, 1.0), half = std::sqrt((1 + cosine) / 2);
    const double handle = length(b - a) / (3 * (1 + half) / 2);
    return {a, a + handle * ta, b - handle * tb, b};
}

template <class Real>
void smoothPiece(const ZeroSet<Real>& zeros, Point a, Point b, Point square, double tolerance, int halvings,
                 SmoothCurves& result, std::vector<Bezier>& out) {
    const Point chord = b - a;
    const double size = length(chord);
    const Point along = size > 0 ? (1 / size) * chord : Point{1, 0};
    Bezier piece = hermite(a, b, zeros.tangent(a, along), zeros.tangent(b, along));
    double worst = 0;
    for (const double t : kSampledAt) worst = std::max(worst, zeros.distance(piece.at(t)));
    if (worst > tolerance) {
        Point middle = 0.5 * (a + b);
        if (halvings > 0 && zeros.project(middle, square)) {
            smoothPiece(zeros, a, middle, square, tolerance, halvings - 1, result, out);
            smoothPiece(zeros, middle, b, square, tolerance, halvings - 1, result, out);
            return;
        }
        piece = {a, a + (1.0 / 3) * chord, b - (1.0 / 3) * chord, b};
        ++result.straightPieces;
    } else {
        result.deviation = std::max(result.deviation, worst);
    }
    out.push_back(piece);
}

}  // namespace

Ring Curves::world(std::size_t ring) const {
    Ring out;
    out.reserve(rings[ring].points.size());
    for (const Point& p : rings[ring].points) out.push_back(frame.toWorld(p));
    return out;
}

std::size_t Curves::outerCount() const { return rings.size() - holeCount(); }

std::size_t Curves::holeCount() const {
    return static_cast<std::size_t>(
        std::count_if(rings.begin(), rings.end(), [](const CurveRing& ring) { return ring.hole; }));
}

std::size_t Curves::pointCount() const {
    std::size_t count = 0;
    for (const CurveRing& ring : rings) count += ring.points.size();
    return count;
}

double Curves::area() const {
    double area = 0;
    for (const CurveRing& ring : rings) area += signedArea(ring.points);
    return area * frame.spacing.x * frame.spacing.y;
}

Point Bezier::at(double t) const {
    const double s = 1 - t;
    return s * s * s * start + 3 * s * s * t * startHandle + 3 * s * t * t * endHandle + t * t * t * end;
}

template <class Real>
Curves extractCurves(const RowField<Real>& field, const Progress& progress) {
    if (field.axis != 0) return extractCurves(transposed(field), progress);
    return Tracer<Real>(field).run(progress);
}

template <class Real>
Curves refined(const RowField<Real>& field, const Curves& curves, double tolerance) {
    const ZeroSet<Real> zeros(field, curves.frame);
    Curves out = curves;
    for (CurveRing& ring : out.rings) {
        const Ring points = std::move(ring.points);
        ring.points.clear();
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Point a = points[i], b = points[(i + 1) % points.size()], square = squareOf(a, b);
            ring.points.push_back(a);
            Ring added;
            if (hasTwoPieces(field, square) ||
                !addPointsBetween(zeros, curves.frame.toWorld(a), curves.frame.toWorld(b), square, tolerance,
                                  kMostHalvings, added))
                continue;
            Ring chain{a};
            for (const Point& p : added) chain.push_back(curves.frame.toLattice(p));
            chain.push_back(b);
            if (isSimple(chain)) ring.points.insert(ring.points.end(), chain.begin() + 1, chain.end() - 1);
        }
    }
    return out;
}

template <class Real>
SmoothCurves smoothed(const RowField<Real>& field, const Curves& curves, double tolerance) {
    const ZeroSet<Real> zeros(field, curves.frame);
    SmoothCurves result;
    for (const CurveRing& ring : curves.rings) {
        std::vector<Bezier>& out = result.rings.emplace_back();
        for (std::size_t i = 0; i < ring.points.size(); ++i) {
            const Point a = ring.points[i], b = ring.points[(i + 1) % ring.points.size()];
            smoothPiece(zeros, curves.frame.toWorld(a), curves.frame.toWorld(b), squareOf(a, b), tolerance,
                        kMostHalvings, result, out);
        }
    }
    return result;
}

#define ISOWAVE_INSTANTIATE(Real)                                          \
    template Curves extractCurves(const RowField<Real>&, const Progress&); \
    template Curves refined(const RowField<Real>&, const Curves&, double); \
    template SmoothCurves smoothed(const RowField<Real>&, const Curves&, double);
ISOWAVE_INSTANTIATE(float)
ISOWAVE_INSTANTIATE(double)
#undef ISOWAVE_INSTANTIATE

}  // namespace isowave::curves2d
